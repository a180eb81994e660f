#include "report/sweep_file.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/json.h"
#include "report/evaluation_report.h"
#include "report/palette.h"
#include "report/sweep_table.h"

namespace vpr {
namespace {

Json best_json(const BestMatchCounts& best) {
  return {{"queries", best.queries}, {"correct", best.correct}, {"ignored", best.ignored}};
}

Json named_cell_json(const std::string& query, const CellCounts& cell, const Sweep& sweep) {
  Json json = {{"query", query},
               {std::string(sweep.score->window_symbol), cell.window},
               {sweep.threshold_symbol, cell.threshold ? Json(*cell.threshold) : Json("auto")}};
  if (cell.scale) json["t_r_scale"] = enum_name(*cell.scale);
  json["counts"] = counts_json(cell.counts);
  if (cell.untrained) json["untrained"] = *cell.untrained;
  json["best_match"] = best_json(cell.counts.best_match);
  return json;
}

Json interval_json(const Interval& interval) { return {interval.low, interval.high}; }

// `first`: the index of the sweep's first cell among those of all sweeps.
Json choice_json(const Sweep& sweep, size_t first) {
  const Recommendation& choice = sweep.recommendation;
  const auto index = [&](const std::optional<size_t>& cell) {
    return cell ? Json(first + *cell) : Json();
  };
  Json json = {
      {"name", sweep.query_name},
      {"ground_truth", sweep.protocol},
      {"recommended", index(choice.cell)},
      {"recommended_settings",
       sweep.recommended_settings ? settings_in_force(*sweep.recommended_settings) : Json()},
      {"advice", enum_name(choice.advice)},
      {"reason", reason_text(sweep)},
      {"near_miss", index(choice.near_miss)},
      {"nearest_error", index(choice.first_error)}};
  json["pareto"] = Json::array();
  for (const size_t cell : choice.pareto) json["pareto"].push_back(first + cell);
  if (sweep.replay) add_replay(json, *sweep.replay);
  if (sweep.intervals) {
    json["intervals"] = {{"block", sweep.intervals->block},
                         {"correct_hits", interval_json(sweep.intervals->correct_hits)},
                         {"incorrect_hits", interval_json(sweep.intervals->incorrect_hits)}};
    if (sweep.cells.front().counts.clusters) {
      json["intervals"]["correct_places"] = interval_json(sweep.intervals->correct_places);
      json["intervals"]["incorrect_places"] = interval_json(sweep.intervals->incorrect_places);
    }
  }
  if (sweep.validation)
    json["validation"] =
        named_cell_json(sweep.validation->query_name, sweep.validation->cell, sweep);
  return json;
}

}  // namespace

Json sweep_json(std::string_view method, const QuerySettings& base,
                const std::vector<Sweep>& sweeps, const RunInfo& run, double seconds) {
  Json json = {
      {"schema", "vpr.sweep/1"}, {"method", method}, {"settings", settings_in_force(base)}};
  for (const Sweep& sweep : sweeps)
    for (const std::string& varied :
         {std::string(sweep.score->window_symbol), sweep.threshold_symbol})
      json["settings"].erase(varied);
  json["cells"] = Json::array();
  json["queries"] = Json::array();
  for (const Sweep& sweep : sweeps) {
    json["queries"].push_back(choice_json(sweep, json["cells"].size()));
    for (const CellCounts& cell : sweep.cells)
      json["cells"].push_back(named_cell_json(sweep.query_name, cell, sweep));
  }
  json["provenance"] = provenance_json(run);
  json["machine"] = machine_json(run);
  json["timing"] = timing_json({{"sweep", seconds}});
  return json;
}

std::string config_text(const QuerySettings& settings) {
  Json json = {{"schema", "vpr.config/1"}};
  json.update(settings_in_force(settings));
  return to_text(json);
}

Chart sweep_chart(const Sweep& sweep) {
  const std::vector<SweepCell> cells = sweep_cells(sweep);
  Chart chart{"correct-incorrect", fmt::format("{}: hits", sweep.query_name), {"incorrect hits"}};
  chart.x.from_zero = true;
  chart.y.label = "correct hits";
  const SweepSymbols symbols = sweep_symbols(sweep);
  for (const std::string& window : distinct_values(cells, &SweepCell::window)) {
    Series series{fmt::format("{} {}", symbols.window, window), {}};
    std::vector<const SweepCell*> order;
    for (const SweepCell& cell : cells)
      if (cell.window == window) order.push_back(&cell);
    // From the strictest threshold to the loosest; automatic ones have no order and stand alone.
    std::stable_sort(order.begin(), order.end(), [](const SweepCell* a, const SweepCell* b) {
      return a->looseness.has_value() != b->looseness.has_value() ? a->looseness.has_value()
                                                                  : a->looseness < b->looseness;
    });
    for (const SweepCell* cell : order) {
      if (!cell->looseness && !series.points.empty()) {
        series.points.push_back(kChartGap);
        series.labels.emplace_back();
      }
      series.points.emplace_back(static_cast<double>(cell->hits.incorrect),
                                 static_cast<double>(cell->hits.correct));
      series.labels.push_back(symbols.threshold + " " + cell->threshold);
    }
    chart.series.push_back(series);
  }
  return chart;
}

namespace {

/// Names side by side, one a unit.
ChartAxis name_axis(const std::string& label, const std::vector<std::string>& names, bool is_down) {
  ChartAxis axis{label};
  const auto end = static_cast<double>(names.size());
  axis.range = is_down ? std::pair(end, 0.0) : std::pair(0.0, end);
  for (size_t i = 0; i < names.size(); ++i)
    axis.ticks.push_back({static_cast<double>(i) + 0.5, names[i]});
  return axis;
}

/// From white to the colour, by the root of the count's share in the largest.
cv::Vec3b shade(const cv::Vec3b& full, uint64_t count, uint64_t most) {
  const double share = std::sqrt(static_cast<double>(count) / static_cast<double>(most));
  cv::Vec3b colour;
  for (int c = 0; c < 3; ++c) colour[c] = static_cast<uint8_t>(255 + share * (full[c] - 255));
  return colour;
}

Chart heat_chart(const Sweep& sweep, const std::string& what, uint64_t LabelCounts::*count,
                 Meaning meaning) {
  const std::vector<SweepCell> cells = sweep_cells(sweep);
  const auto windows = distinct_values(cells, &SweepCell::window);
  const auto thresholds = distinct_values(cells, &SweepCell::threshold);
  const SweepSymbols symbols = sweep_symbols(sweep);
  Chart chart{"heat-map", fmt::format("{}: {}", sweep.query_name, what)};
  chart.x = name_axis(symbols.window, windows, false);
  chart.y = name_axis(symbols.threshold, thresholds, true);
  uint64_t most = 1;
  for (const SweepCell& cell : cells) most = std::max(most, cell.hits.*count);
  cv::Mat image(static_cast<int>(thresholds.size()), static_cast<int>(windows.size()), CV_8UC3,
                cv::Scalar::all(255));
  Series numbers{"", {}, SeriesStyle::points, meaning, SeriesMark::none};
  for (const SweepCell& cell : cells) {
    const auto w = std::find(windows.begin(), windows.end(), cell.window) - windows.begin();
    const auto t =
        std::find(thresholds.begin(), thresholds.end(), cell.threshold) - thresholds.begin();
    image.at<cv::Vec3b>(static_cast<int>(t), static_cast<int>(w)) =
        shade(bgr_of(meaning), cell.hits.*count, most);
    numbers.points.emplace_back(static_cast<double>(w) + 0.5, static_cast<double>(t) + 0.5);
    numbers.labels.push_back(std::to_string(cell.hits.*count));
  }
  chart.series = {numbers};
  chart.image = chart_image(image, 1);
  return chart;
}

}  // namespace

std::string heat_map_png(const std::vector<Sweep>& sweeps) {
  std::vector<Chart> charts;
  for (const Sweep& sweep : sweeps) {
    charts.push_back(heat_chart(sweep, "correct hits", &LabelCounts::correct, Meaning::right));
    charts.push_back(heat_chart(sweep, "incorrect hits", &LabelCounts::incorrect, Meaning::wrong));
  }
  return chart_png(charts, 2);
}

}  // namespace vpr
