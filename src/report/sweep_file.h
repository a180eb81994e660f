// Sweeps (vpr.sweep/1) as JSON and pictures; sweep_table.h has the tables.
#pragma once

#include "base/json.h"
#include "base/statistics.h"
#include "evaluation/sweep.h"
#include "report/chart.h"

namespace vpr {

/// What is known of the uncertainty of the recommended setting: 95 % intervals of its counts.
struct SweepIntervals {
  size_t block = 1;  ///< frames that are drawn together
  Interval correct_hits;
  Interval incorrect_hits;
  Interval correct_places = {};  ///< of sequences; a place counts at its mean query window
  Interval incorrect_places = {};
};

/// One query's sweep, which has a cell.
struct Sweep {
  std::string query_name;
  const ScoreKind* score = &score_kind(Score::raw);  ///< what thresholds are of
  std::vector<CellCounts> cells;                     ///< by window, then threshold
  Recommendation recommendation;
  std::optional<Json> recommended_settings;  ///< all of them, as vpr-query --config takes them
  std::optional<SweepIntervals> intervals;
  std::optional<Json> validation;  ///< query and counts of the recommended setting elsewhere
  std::string protocol;            ///< of the ground truth, in words
};

/// The cells of all sweeps ("cells", each with its "query"), and of each what to choose ("queries",
/// which name cells by their index in the whole list).
void add_sweeps(Json& json, const std::vector<Sweep>& sweeps);

/// Correct against incorrect hits, a line a window.
Chart sweep_chart(const Sweep& sweep);

/// Correct and incorrect hits over the grid, side by side, one sweep below the other: a PNG file.
std::string heat_map_png(const std::vector<Sweep>& sweeps);

}  // namespace vpr
