// The reference implementation of the filter over places and rates, in double precision and cell by
// cell, and of its recognized paths.
#pragma once

#include <span>
#include <vector>

#include "match/filter_track.h"

namespace vpr {

struct ReferenceFilter {
  FilterCells cells;
  std::vector<std::vector<double>> rates;  ///< mass by rate and cell
  std::vector<double> masses;  ///< by cell, summed over rates; 0 for a cell that is not a place
};

ReferenceFilter start_reference_filter(const FilterCells& cells);

void advance_reference_filter(ReferenceFilter& filter, std::span<const uint16_t> scores);

/// The value of a place in deviations: minus its evidence.
double reference_value(const ReferenceFilter& filter, size_t cell);

/// A keyframe of the query on its path.
struct ReferenceKeyframe {
  size_t path = 0;  ///< from 1 on
  uint32_t margin = 0;
  size_t cell = 0;  ///< the place, traced back from the last keyframe that changes it
};

/// The paths of a query. As follow_keyframe, but from the values of all keyframes at once, and
/// their distances to the best places. `track`: before the first keyframe.
std::vector<ReferenceKeyframe> reference_paths(const FilterCells& cells,
                                               std::span<const std::vector<uint32_t>> values,
                                               std::span<const uint32_t> distances,
                                               const PathTrack& track);

}  // namespace vpr
