// Counts over a grid of settings, and which setting to choose.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "evaluation/counts.h"

namespace vpr {

struct SequenceCellCounts {
  uint64_t window_length = 0;
  std::optional<double> distance_threshold;
  ThresholdScale scale = ThresholdScale::bits;  ///< automatic thresholds are in bits
  SequenceCounts counts;
};

struct FabmapCellCounts {
  uint64_t window = 0;
  double place_threshold = 0;
  FabmapCounts counts;
};

/// What a choice looks at: places for sequences, (frame, place) recognitions for FAB-MAP.
struct SweepScore {
  uint64_t distinct = 0;            ///< places recognised correctly
  uint64_t incorrect = 0;           ///< wrong ones
  uint64_t hits = 0;                ///< correct hits
  uint64_t window = 0;              ///< c_l or c_w
  std::optional<double> threshold;  ///< t_r or t_p; none: automatic
};

SweepScore score_of(const SequenceCellCounts& cell);
SweepScore score_of(const FabmapCellCounts& cell);

struct Recommendation {
  /// The cell with most distinct correct places and no incorrect one; of equals the one with most
  /// hits, then the shortest window, then the first. None where every cell has an incorrect place,
  /// or none has a correct one.
  std::optional<size_t> cell;
  std::string reason;          ///< in words
  std::vector<size_t> pareto;  ///< cells that no other beats in both distinct and incorrect places
  /// The cell with an incorrect place and the same window whose threshold is nearest to the
  /// recommended one; automatic ones are not compared. None where there is none.
  std::optional<size_t> nearest_error;
};

Recommendation recommend(std::span<const SweepScore> scores);

}  // namespace vpr
