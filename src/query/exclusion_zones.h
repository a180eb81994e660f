// Exclusion zones around best matches, margins over the runners-up outside them, and the detection
// of training sequences that show the same place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/monitor.h"
#include "match/frame_distances.h"
#include "match/match.h"
#include "query/row_scan.h"

namespace vpr {

/// The exclusion zone of a best match: in its sequence, the windows at most w before or after it;
/// in a sequence of the same place, all windows; in any other sequence, none.
struct ExclusionZones {
  std::vector<uint32_t> widths;                ///< w, the exclusion radius, by sequence
  std::vector<std::vector<uint8_t>> overlaps;  ///< [a][b]: whether a and b overlap (same place)
};

/// Exclusion zones for sequences of different places, except for the overlapping pairs.
ExclusionZones make_exclusion_zones(std::vector<uint32_t> radii,
                                    const std::vector<std::pair<size_t, size_t>>& overlapping);

/// The smallest k for which frames k apart differ, on average, by at least half of the mean
/// distance of all frames of the sequence; the number of frames if there is no such k; at least 1.
/// Uses every frame, or about 10 000 evenly spread frames of a longer sequence.
size_t exclusion_radius(const DescribedFrames& sequence, const Monitor& monitor = {});

/// The margin of every row: the smallest score outside the exclusion zone minus the smallest score,
/// with ties to the smallest sequence and train window. Accepts whole rows of integers of which
/// smaller ones are better. The zones must outlive the scan.
class MarginScan {
 public:
  MarginScan(const ExclusionZones& zones, size_t query_windows)
      : zones_(zones), margins_(query_windows) {}
  void operator()(std::span<const ScoreRow> row);
  /// By query window; nullopt for a window without a row or without a runner-up.
  const std::vector<std::optional<uint32_t>>& result() const { return margins_; }

 private:
  const ExclusionZones& zones_;
  std::vector<std::optional<uint32_t>> margins_;
};

/// Pairs (a, b), a < b, increasing, of sequences that show the same place at least in part: one of
/// the two is a query of the other, and at least a tenth of its windows are recognized. Windows are
/// 20 frames of z-scores (or half of the shorter sequence, but at least 4), recognized by the
/// default margin. `radii`: the exclusion radius of every sequence. Longer sequences are compared
/// in evenly spread parts of 1000 frames, at least two per sequence, with at most most_pairs frame
/// pairs in total. Throws Error(interrupted) on a stop.
std::vector<std::pair<size_t, size_t>> find_overlapping_sequences(
    std::span<const DescribedFrames> sequences, const std::vector<uint32_t>& radii,
    const Monitor& monitor, size_t most_pairs = size_t{1} << 30);

}  // namespace vpr
