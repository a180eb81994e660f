// The reference implementation of the filter over places and rates, in double precision and cell by
// cell.
#pragma once

#include <span>
#include <vector>

#include "match/filter.h"

namespace vpr {

/// The state: masses that sum to 1.
struct PlainFilter {
  FilterCells cells;
  FilterSettings settings;
  std::vector<std::vector<double>> rates;  ///< by rate and cell
  std::vector<double> masses;  ///< by cell, summed over rates; 0 for a cell that is not a place
  double off_map = 0.5;
};

PlainFilter start_plain_filter(const FilterCells& cells, const FilterSettings& settings);

void advance_plain_filter(PlainFilter& filter, std::span<const uint16_t> scores);

/// Values in deviations: -log(mass) / sharpness.
double plain_value(const PlainFilter& filter, size_t cell);
double plain_nowhere_value(const PlainFilter& filter);

/// A keyframe of the query, in scores.
struct PlainView {
  size_t cell = 0;  ///< of the best place
  size_t sequence = 0;
  uint32_t margin = 0;  ///< of the best place, confirmed or not
  /// -z at the best places of the path's last keyframes, this one last, with the current
  /// statistics.
  std::vector<int32_t> supports;
  /// change of the query minus change of the training walk, since the last keyframe
  double excess = 0;
};

/// How much likelier a path is than the off-map state, in deviations, as rescore: `scores` are
/// the scores of its keyframes, each to the cells of one run around the path, 65535 for cells that
/// are not near. `best`: the last best cell among these. `places`: of the whole map.
double plain_path_margin(std::span<const std::vector<uint16_t>> scores, size_t best, size_t places,
                         const FilterSettings& settings);

/// Which keyframes of a query are confirmed, from the first on. As follow_keyframe, but every
/// keyframe examines its whole path: time O(keyframes^3).
std::vector<uint8_t> plain_confirmed(std::span<const PlainView> views,
                                     const FilterSettings& settings);

/// The maximum error of a value in deviations: scores are grouped, and logarithms and values
/// rounded. It grows with the number of keyframes.
double filter_tolerance(size_t views);

}  // namespace vpr
