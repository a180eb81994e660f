// The reference implementation of past_zscores: z-scores of a sequence against its own past, in
// double precision and pair by pair.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "match/zscores.h"

namespace vpr {

/// The common data of all columns, by frame.
struct ReferencePast {
  std::vector<double> row_means;     ///< r; 0 for a row without a past
  std::vector<double> means_so_far;  ///< R; 0 before the first row with a past
  std::vector<double> variances;     ///< V
  std::vector<uint8_t> has_past;     ///< of a readable frame
  /// The frame whose distances are added to the statistics before this one is scored.
  std::vector<std::optional<size_t>> learned;
};

/// `past`: for each frame, the number of frames from the first on that it may match.
ReferencePast reference_past(const DescribedFrames& walk, std::span<const uint32_t> past,
                             const Monitor& monitor);

/// z of the frames up to `last` to frame `column`, within [-32, 32); 0 for frames that are not
/// after it.
std::vector<double> reference_past_scores(const DescribedFrames& walk,
                                          std::span<const uint32_t> past,
                                          const ReferencePast& shared, size_t column, size_t last);

}  // namespace vpr
