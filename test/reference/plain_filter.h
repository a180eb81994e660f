// The filter over places and rates as it is stated, in double precision and cell by cell: the
// oracle.
#pragma once

#include <span>
#include <vector>

#include "match/filter.h"

namespace vpr {

/// What is believed: masses that sum to 1.
struct PlainFilter {
  FilterCells cells;
  FilterSettings settings;
  std::vector<std::vector<double>> rates;  ///< by rate and cell
  std::vector<double> masses;              ///< by cell, over rates; 0 for one that is no place
  double nowhere = 0.5;
};

PlainFilter start_plain_filter(const FilterCells& cells, const FilterSettings& settings);

/// As advance_filter.
void advance_plain_filter(PlainFilter& filter, std::span<const uint16_t> scores);

/// Values in deviations: -log(mass) / sharpness.
double plain_value(const PlainFilter& filter, size_t cell);
double plain_nowhere_value(const PlainFilter& filter);

/// What a view of the query shows, in scores.
struct PlainView {
  size_t cell = 0;  ///< of the best place
  size_t sequence = 0;
  uint32_t margin = 0;  ///< of the best place, trusted or not
  /// -z at the best places of its path's last views, its own the last, as known by now.
  std::vector<int32_t> supports;
  double excess = 0;  ///< change of the query less that of the training walk, since the last view
};

/// How much likelier a path is than being nowhere, in deviations, as read_again: `scores` are those
/// of its views, each to the cells of one run around the path, 65535 where a cell is not near.
/// `best`: the last best cell of these. `places`: of the whole map.
double plain_path_margin(std::span<const std::vector<uint16_t>> scores, size_t best, size_t places,
                         const FilterSettings& settings);

/// Which views are believed, of those of a query from the first on. As follow_view, but every view
/// looks back at all of its path: time O(views^3).
std::vector<uint8_t> plain_belief(std::span<const PlainView> views, const FilterSettings& settings);

/// The largest difference of a value, in deviations: scores are grouped, and logarithms and values
/// rounded. It grows with the views taken.
double filter_tolerance(size_t views);

}  // namespace vpr
