// Standardized scores of a walk against its own past as they are defined, in double precision and
// pair by pair: the oracle of past_scores.h.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "match/standardization.h"

namespace vpr {

/// What all columns share, by frame of the walk.
struct PlainPast {
  std::vector<double> row_means;     ///< r; 0 of a row without a past
  std::vector<double> means_so_far;  ///< R; 0 before the first row with a past
  std::vector<double> variances;     ///< V
  std::vector<uint8_t> has_past;     ///< of a readable frame
  /// The frame whose distances are learned before this one is scored.
  std::vector<std::optional<size_t>> learned;
};

/// `past`: by frame, how many frames from the first on it may match.
PlainPast plain_past(const DescriptorSpan& walk, std::span<const uint32_t> past,
                     const StandardizationSettings& settings, const Monitor& monitor);

/// z of the frames up to `last` to frame `column`, within [-32, 32); 0 of frames that are not
/// behind it.
std::vector<double> plain_past_scores(const DescriptorSpan& walk, std::span<const uint32_t> past,
                                      const StandardizationSettings& settings,
                                      const PlainPast& shared, size_t column, size_t last);

}  // namespace vpr
