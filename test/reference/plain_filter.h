// The reference implementation of the filter over places and rates, in double precision and cell by
// cell, and of its recognized paths.
#pragma once

#include <span>
#include <vector>

#include "match/filter.h"

namespace vpr {

struct PlainFilter {
  FilterCells cells;
  std::vector<std::vector<double>> rates;  ///< mass by rate and cell
  std::vector<double> masses;  ///< by cell, summed over rates; 0 for a cell that is not a place
};

PlainFilter start_plain_filter(const FilterCells& cells);

void advance_plain_filter(PlainFilter& filter, std::span<const uint16_t> scores);

/// The value of a place in deviations: minus its evidence.
double plain_value(const PlainFilter& filter, size_t cell);

/// A keyframe of the query on its path.
struct PlainKeyframe {
  size_t path = 0;  ///< from 1 on
  uint32_t margin = 0;
  size_t cell = 0;  ///< the place, traced back from the last keyframe that changes it
};

/// The paths of a query. As follow_keyframe, but from the values of all keyframes at once.
std::vector<PlainKeyframe> plain_paths(const FilterCells& cells,
                                       std::span<const std::vector<uint32_t>> values,
                                       const FilterSettings& settings);

}  // namespace vpr
