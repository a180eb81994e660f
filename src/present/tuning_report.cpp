#include "present/tuning_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/json.h"
#include "base/json_fields.h"
#include "base/text.h"
#include "present/evaluation_report.h"
#include "present/palette.h"

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
  if (cell.unknown_place) json["unknown_place"] = *cell.unknown_place;
  json["best_match"] = best_json(cell.counts.best_match);
  return json;
}

// `first`: the index of the sweep's first cell among those of all sweeps.
Json choice_json(const Sweep& sweep, size_t first) {
  const Recommendation& choice = sweep.recommendation;
  const auto index = [&](const std::optional<size_t>& cell) {
    return cell ? Json(first + *cell) : Json();
  };
  Json json = {
      {"name", sweep.query.name},
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
  add_selection(json, sweep.query.selection);
  if (sweep.intervals) {
    json["intervals"] = {
        {"block", sweep.intervals->block},
        {"correct_recognitions", interval_json(sweep.intervals->correct_recognitions)},
        {"incorrect_recognitions", interval_json(sweep.intervals->incorrect_recognitions)}};
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

std::string window_text(const CellCounts& cell) { return std::to_string(cell.window); }

std::string threshold_text(const CellCounts& cell) {
  return cell.threshold ? fmt::format("{}", *cell.threshold) : "auto";
}

/// Different values of one setting in order of first occurrence.
std::vector<std::string> distinct_texts(const Sweep& sweep,
                                        std::string (*text)(const CellCounts&)) {
  std::vector<std::string> values;
  for (const CellCounts& cell : sweep.cells)
    if (std::ranges::find(values, text(cell)) == values.end()) values.push_back(text(cell));
  return values;
}

bool has_places(const Sweep& sweep) { return sweep.cells.front().counts.clusters.has_value(); }

std::string cell_name(const Sweep& sweep, const CellCounts& cell) {
  const std::string scale = cell.scale ? fmt::format(" ({})", enum_name(*cell.scale)) : "";
  return fmt::format("{} {}, {} {}{}", sweep.score->window_symbol, cell.window,
                     sweep.threshold_symbol, threshold_text(cell), scale);
}

/// The correct and the incorrect count of a cell.
using CellTexts = std::array<std::string, 2> (*)(const Counts&);

std::array<std::string, 2> label_texts(const LabelCounts& counts, const std::string& more = "") {
  return {std::to_string(counts.correct) + more, std::to_string(counts.incorrect)};
}

// A row per query and threshold, or per query for counts that do not depend on the threshold.
Table grid_table(const std::vector<Sweep>& sweeps, const std::string& title, CellTexts texts,
                 bool every_threshold, bool star) {
  Table table;
  table.title = sweeps.size() > 1 ? title : sweeps.front().query.name + ": " + title;
  if (sweeps.size() > 1) table.columns.emplace_back("query");
  if (every_threshold) table.columns.push_back(sweeps.front().threshold_symbol);
  for (const std::string& window : distinct_texts(sweeps.front(), window_text))
    table.columns.insert(table.columns.end(), {window + " right", window + " wrong"});
  for (const Sweep& sweep : sweeps) {
    for (const std::string& threshold : distinct_texts(sweep, threshold_text)) {
      std::vector<std::string>& row = table.rows.emplace_back();
      if (sweeps.size() > 1) row.push_back(sweep.query.name);
      if (every_threshold) row.push_back(threshold);
      for (size_t c = 0; c < sweep.cells.size(); ++c) {
        if (threshold_text(sweep.cells[c]) != threshold) continue;
        auto [right, wrong] = texts(sweep.cells[c].counts);
        if (star && sweep.recommendation.cell == c) right += "*";
        row.insert(row.end(), {right, wrong});
      }
      if (!every_threshold) break;
    }
  }
  return table;
}

std::string first_error_text(const Sweep& sweep) {
  const Recommendation& choice = sweep.recommendation;
  const std::string window =
      fmt::format("{} {}", sweep.score->window_symbol, sweep.cells[*choice.cell].window);
  if (!choice.first_error)
    return fmt::format("{} has no incorrect recognition in the whole grid.\n", window);
  const CellCounts& error = sweep.cells[*choice.first_error];
  const LabelCounts& recognitions = error.counts.recognitions;
  if (recognitions.incorrect == 0)
    return fmt::format("At {} {}, {} of {} would be wrong, were their places not trained.\n",
                       sweep.threshold_symbol, threshold_text(error),
                       counted(*error.unknown_place, "window"), window);
  return fmt::format("The first error of {} is at {} {}: {}, {} correct.\n", window,
                     sweep.threshold_symbol, threshold_text(error),
                     counted(recognitions.incorrect, "incorrect recognition"),
                     recognitions.correct);
}

bool knows_untrained(const Sweep& sweep) {
  return std::ranges::any_of(sweep.cells, &std::optional<uint64_t>::has_value,
                             &CellCounts::unknown_place);
}

std::string intervals_text(const SweepIntervals& intervals, bool with_places) {
  const auto range = [](const Interval& interval) {
    return fmt::format("{:.0f} to {:.0f}", interval.low, interval.high);
  };
  std::string text =
      fmt::format("Correct recognitions {}, incorrect {}", range(intervals.correct_recognitions),
                  range(intervals.incorrect_recognitions));
  if (with_places)
    text += fmt::format("; correct places {}, incorrect {}", range(intervals.correct_places),
                        range(intervals.incorrect_places));
  return text + fmt::format(" (95 %, blocks of {}).\n", counted(intervals.block, "frame"));
}

/// A name per unit.
ChartAxis name_axis(std::string_view label, const std::vector<std::string>& names, bool is_down) {
  ChartAxis axis{std::string(label)};
  const auto end = static_cast<double>(names.size());
  axis.range = is_down ? std::pair(end, 0.0) : std::pair(0.0, end);
  for (size_t i = 0; i < names.size(); ++i)
    axis.ticks.push_back({static_cast<double>(i) + 0.5, names[i]});
  return axis;
}

Chart heat_chart(const Sweep& sweep, const std::string& what, uint64_t LabelCounts::*count,
                 Meaning meaning) {
  const auto windows = distinct_texts(sweep, window_text);
  const auto thresholds = distinct_texts(sweep, threshold_text);
  Chart chart{"heat-map", fmt::format("{}: {}", sweep.query.name, what)};
  chart.x = name_axis(sweep.score->window_symbol, windows, false);
  chart.y = name_axis(sweep.threshold_symbol, thresholds, true);
  uint64_t most = 1;
  for (const CellCounts& cell : sweep.cells) most = std::max(most, cell.counts.recognitions.*count);
  cv::Mat image(static_cast<int>(thresholds.size()), static_cast<int>(windows.size()), CV_8UC3,
                cv::Scalar::all(255));
  Series numbers{"", {}, SeriesStyle::points, meaning, SeriesMark::none};
  for (const CellCounts& cell : sweep.cells) {
    const auto x = std::ranges::find(windows, window_text(cell)) - windows.begin();
    const auto y = std::ranges::find(thresholds, threshold_text(cell)) - thresholds.begin();
    const uint64_t recognitions = cell.counts.recognitions.*count;
    // From white to the full color, by the square root of the share in the largest count.
    const double share = std::sqrt(static_cast<double>(recognitions) / static_cast<double>(most));
    cv::Vec3b& pixel = image.at<cv::Vec3b>(static_cast<int>(y), static_cast<int>(x));
    const cv::Vec3b full = bgr_of(meaning);
    for (int c = 0; c < 3; ++c) pixel[c] = static_cast<uint8_t>(255 + share * (full[c] - 255));
    numbers.points.emplace_back(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
    numbers.labels.push_back(std::to_string(recognitions));
  }
  chart.series = {numbers};
  chart.image = chart_image(image, 1);
  return chart;
}

constexpr double kSecondsPerHour = 3600;

/// False recognitions to expect in another number of windows.
struct ScaledRate {
  double expected = 0;
  Interval interval;
};

ScaledRate rate_of(const CalibratedLength& length, double windows) {
  const FalseRecognitions& found = length.calibration.expected;
  const double factor = windows / static_cast<double>(length.windows);
  return {static_cast<double>(found.seen) * factor,
          {found.interval.low * factor, found.interval.high * factor}};
}

Json rate_json(const ScaledRate& rate) {
  return {{"expected", rate.expected}, {"interval", interval_json(rate.interval)}};
}

Json length_json(const CalibratedLength& length) {
  const Calibration& found = length.calibration;
  Json json = {{"c_l", length.settings.window_length},
               {"windows", length.windows},
               {"queries", length.queries},
               {"advice", enum_name(found.advice)},
               {"margin", nullptr}};
  if (!found.strength) return json;
  json["margin"] = *length.settings.margin;
  json["recognized"] = {{"correct", found.correct}, {"incorrect", found.incorrect}};
  json["false_recognitions"] = {{"block", length.block},
                                {"seen", found.expected.seen},
                                {"interval", interval_json(found.expected.interval)}};
  return json;
}

}  // namespace

Json sweep_json(std::string_view method, const QuerySettings& base,
                const std::vector<Sweep>& sweeps, const RunInfo& run, double seconds) {
  Json json = {
      {"schema", "vpr.sweep/3"}, {"method", method}, {"settings", settings_in_force(base)}};
  for (const Sweep& sweep : sweeps)
    for (const std::string& varied :
         {std::string(sweep.score->window_symbol), sweep.threshold_symbol})
      json["settings"].erase(varied);
  json["cells"] = Json::array();
  json["queries"] = Json::array();
  for (const Sweep& sweep : sweeps) {
    json["queries"].push_back(choice_json(sweep, json["cells"].size()));
    for (const CellCounts& cell : sweep.cells)
      json["cells"].push_back(named_cell_json(sweep.query.name, cell, sweep));
  }
  json["provenance"] = provenance_json(run);
  add_run(json, run, {{"sweep", seconds}});
  return json;
}

std::string config_text(const QuerySettings& settings) {
  Json json = {{"schema", "vpr.config/3"}};
  json.update(settings_in_force(settings));
  return to_text(json);
}

Chart sweep_chart(const Sweep& sweep) {
  Chart chart{"correct-incorrect",
              fmt::format("{}: recognitions", sweep.query.name),
              {"incorrect recognitions"}};
  chart.x.from_zero = true;
  chart.y.label = "correct recognitions";
  const auto looseness = [&](const CellCounts* cell) {
    return looseness_of(*cell, sweep.threshold_order);
  };
  for (const std::string& window : distinct_texts(sweep, window_text)) {
    Series series{fmt::format("{} {}", sweep.score->window_symbol, window), {}};
    std::vector<const CellCounts*> order;
    for (const CellCounts& cell : sweep.cells)
      if (window_text(cell) == window) order.push_back(&cell);
    // From the strictest threshold to the loosest; automatic ones have no order and stand alone.
    std::ranges::stable_sort(
        order,
        [](const auto& a, const auto& b) {
          return a.has_value() != b.has_value() ? a.has_value() : a < b;
        },
        looseness);
    for (const CellCounts* cell : order) {
      if (!looseness(cell) && !series.points.empty()) {
        series.points.push_back(kChartGap);
        series.labels.emplace_back();
      }
      series.points.emplace_back(static_cast<double>(cell->counts.recognitions.incorrect),
                                 static_cast<double>(cell->counts.recognitions.correct));
      series.labels.push_back(sweep.threshold_symbol + " " + threshold_text(*cell));
    }
    chart.series.push_back(series);
  }
  return chart;
}

std::string heat_map_png(const std::vector<Sweep>& sweeps) {
  std::vector<Chart> charts;
  for (const Sweep& sweep : sweeps) {
    charts.push_back(
        heat_chart(sweep, "correct recognitions", &LabelCounts::correct, Meaning::right));
    charts.push_back(
        heat_chart(sweep, "incorrect recognitions", &LabelCounts::incorrect, Meaning::wrong));
  }
  return chart_png(charts, 2);
}

std::vector<Table> sweep_tables(const std::vector<Sweep>& sweeps) {
  const Sweep& first = sweeps.front();
  const bool any_star = std::ranges::any_of(
      sweeps, [](const Sweep& sweep) { return sweep.recommendation.cell.has_value(); });
  std::vector<Table> tables = {grid_table(
      sweeps,
      fmt::format("recognitions by {} and {}{}", first.threshold_symbol, first.score->window_symbol,
                  any_star ? " (* recommended)" : ""),
      [](const Counts& counts) { return label_texts(counts.recognitions); }, true, true)};
  const bool any_mixed = std::ranges::any_of(sweeps, [](const Sweep& sweep) {
    return std::ranges::any_of(
        sweep.cells, [](const CellCounts& cell) { return cell.counts.mixed_clusters > 0; });
  });
  if (has_places(first))
    tables.push_back(grid_table(
        sweeps,
        any_mixed
            ? "places, judged at their mean (in brackets: right there, but with wrong recognitions)"
            : "places",
        [](const Counts& counts) {
          const uint64_t mixed = counts.mixed_clusters;
          return label_texts(*counts.clusters, mixed > 0 ? fmt::format(" ({})", mixed) : "");
        },
        true, false));
  tables.push_back(grid_table(
      sweeps, fmt::format("best matches by {}", first.score->window_symbol),
      [](const Counts& counts) {
        const BestMatchCounts& best = counts.best_match;
        return label_texts({best.correct, best.queries - best.ignored - best.correct, 0});
      },
      false, false));
  return tables;
}

Table cells_table(const std::vector<Sweep>& sweeps) {
  Table table;
  for (const std::string_view column :
       split("query,,,scale,recognitions_correct,recognitions_incorrect,recognitions_ignored,"
             "places_correct,places_mixed,places_incorrect,places_ignored,distinct,"
             "best_match_correct,best_match_queries,best_match_ignored,pareto,recommended",
             ','))
    table.columns.emplace_back(column);
  table.columns[1] = sweeps.front().score->window_symbol;
  table.columns[2] = sweeps.front().threshold_symbol;
  for (const Sweep& sweep : sweeps)
    for (size_t c = 0; c < sweep.cells.size(); ++c) {
      const CellCounts& cell = sweep.cells[c];
      const auto& [recognitions, places, mixed, distinct, best] = cell.counts;
      const Recommendation& choice = sweep.recommendation;
      const auto of_places = [&](uint64_t count) { return places ? std::to_string(count) : ""; };
      const LabelCounts judged = places.value_or(LabelCounts{});
      const bool is_pareto = std::ranges::find(choice.pareto, c) != choice.pareto.end();
      add_row(table, sweep.query.name, cell.window, threshold_text(cell),
              cell.scale ? enum_name(*cell.scale) : sweep.score->measure, recognitions.correct,
              recognitions.incorrect, recognitions.ignored, of_places(judged.correct),
              of_places(mixed), of_places(judged.incorrect), of_places(judged.ignored), distinct,
              best.correct, best.queries, best.ignored, is_pareto ? "yes" : "no",
              choice.cell == c ? "yes" : "no");
    }
  return table;
}

std::string reason_text(const Sweep& sweep) {
  const Recommendation& choice = sweep.recommendation;
  const std::string& symbol = sweep.threshold_symbol;
  const auto correct = [&](const std::optional<size_t>& cell) {
    return counted(sweep.cells[*cell].counts.recognitions.correct, "correct recognition");
  };
  const std::string near_miss =
      choice.near_miss
          ? fmt::format("{} has {} and no incorrect one",
                        cell_name(sweep, sweep.cells[*choice.near_miss]), correct(choice.near_miss))
          : "";
  switch (choice.advice) {
    case Advice::recommended:
      if (sweep.cells[*choice.cell].unknown_place)
        return correct(choice.cell) +
               ", the most of all settings that neither have an incorrect recognition nor would, "
               "were the places not trained";
      return fmt::format(
          "{}, the most of all settings without an incorrect recognition at "
          "this, every stricter and the next looser {}",
          correct(choice.cell), symbol);
    case Advice::no_recognitions:
      return "no setting has a recognition";
    case Advice::no_correct_recognitions:
      return "all recognitions are incorrect; check that the ground truth belongs to this query";
    case Advice::always_errors:
      return fmt::format("every setting with a correct recognition also has an incorrect one{}",
                         knows_untrained(sweep) ? ", or would if its place were not trained" : "");
    case Advice::next_errs:
      return fmt::format("{}, but the next looser {} of the grid, {}, has one; add steps between",
                         near_miss, symbol, threshold_text(sweep.cells[*choice.first_error]));
    case Advice::grid_ends:
      return fmt::format("{}, but the grid has no looser {} that shows how near the first error is",
                         near_miss, symbol);
    case Advice::only_automatic:
      return fmt::format("an automatic {} has no next looser one to compare with; add numbers",
                         symbol);
  }
  return {};
}

std::string recommendation_text(const Sweep& sweep) {
  const Recommendation& choice = sweep.recommendation;
  if (!choice.cell)
    return fmt::format("{}: no recommendation: {}.\n", sweep.query.name, reason_text(sweep));
  std::string text = fmt::format("{}: recommended: {}: {}.\n", sweep.query.name,
                                 cell_name(sweep, sweep.cells[*choice.cell]), reason_text(sweep)) +
                     first_error_text(sweep);
  if (sweep.intervals) text += intervals_text(*sweep.intervals, has_places(sweep));
  const bool may_generalize = sweep.score == &probability_kind() || knows_untrained(sweep);
  return text + (may_generalize
                     ? "It may be wrong on another sequence.\n"
                     : "It may be wrong on another sequence: --decide margin generalizes "
                       "better.\n");
}

std::string validation_text(const ValidatedCell& validation) {
  const Counts& counts = validation.cell.counts;
  const auto pair_text = [](const LabelCounts& labels) {
    return fmt::format("{} right, {} wrong", labels.correct, labels.incorrect);
  };
  std::string text =
      fmt::format("On {}: recognitions {}", validation.query_name, pair_text(counts.recognitions));
  if (counts.clusters)
    text += fmt::format("; places {}{}", pair_text(*counts.clusters),
                        counts.mixed_clusters == 0
                            ? ""
                            : fmt::format(" ({} of the right ones with wrong recognitions)",
                                          counts.mixed_clusters));
  const BestMatchCounts& best = counts.best_match;
  return text +
         fmt::format("; best matches {} of {} right.\n", best.correct, best.queries - best.ignored);
}

Json calibration_json(const CalibratedSequence& calibrated, const CalibrationRequest& request,
                      const RunInfo& run, double seconds) {
  Json json = {{"schema", "vpr.calibration/3"},
               {"settings", nullptr},
               {"query", {{"name", calibrated.query.name}, {"ground_truth", calibrated.protocol}}},
               {"precision", request.precision},
               {"chosen", calibrated.chosen ? Json(*calibrated.chosen) : Json()},
               {"lengths", Json::array()}};
  add_selection(json["query"], calibrated.query.selection);
  for (const CalibratedLength& length : calibrated.lengths)
    json["lengths"].push_back(length_json(length));
  if (calibrated.chosen) {
    const CalibratedLength& length = calibrated.lengths[*calibrated.chosen];
    json["settings"] = settings_in_force(length.settings);
    json["in_1000_windows"] = rate_json(rate_of(length, 1000));
    if (request.fps) {
      json["fps"] = *request.fps;
      json["in_an_hour"] = rate_json(rate_of(length, *request.fps * kSecondsPerHour));
    }
  }
  json["provenance"] = provenance_json(run);
  add_run(json, run, {{"calibrate", seconds}});
  return json;
}

Table calibration_table(const CalibratedSequence& calibrated) {
  Table table;
  table.title = fmt::format("{}: windows recognized at the margin found{}", calibrated.query.name,
                            calibrated.chosen ? " (* chosen)" : "");
  table.columns = {"c_l", "margin", "correct", "incorrect", "of", "false recognitions", "95 %"};
  for (size_t l = 0; l < calibrated.lengths.size(); ++l) {
    const CalibratedLength& length = calibrated.lengths[l];
    const Calibration& found = length.calibration;
    const std::string name =
        fmt::format("{}{}", length.settings.window_length, calibrated.chosen == l ? "*" : "");
    if (!found.strength) {
      add_row(table, name, "-", "-", "-", length.windows, "-", "-");
      continue;
    }
    const Interval& interval = found.expected.interval;
    add_row(table, name, fmt::format("{:.4g}", *length.settings.margin), found.correct,
            found.incorrect, length.windows, found.expected.seen,
            fmt::format("{:.1f} to {:.1f}", interval.low, interval.high));
  }
  return table;
}

std::string calibration_text(const CalibratedSequence& calibrated,
                             const CalibrationRequest& request) {
  if (!calibrated.chosen)
    return fmt::format("{}: no margin: {}.\n", calibrated.query.name,
                       calibration_failure(calibrated));
  const CalibratedLength& length = calibrated.lengths[*calibrated.chosen];
  const Calibration& found = length.calibration;
  std::string text = fmt::format(
      "{}: margin {:.4g} at c_l {}: {} recognized correctly and {} incorrectly, of {} whose place "
      "is trained.\n",
      calibrated.query.name, *length.settings.margin, length.settings.window_length,
      counted(found.correct, "window"), found.incorrect, length.queries);
  const ScaledRate rate =
      request.fps ? rate_of(length, *request.fps * kSecondsPerHour) : rate_of(length, 1000);
  text += fmt::format("False recognitions to expect in {}: {:.0f} (95 %: {:.0f} to {:.0f}).\n",
                      request.fps ? "an hour" : "1000 windows", rate.expected, rate.interval.low,
                      rate.interval.high);
  return text + "Other rooms or another speed may give more.\n";
}

std::string calibration_failure(const CalibratedSequence& calibrated) {
  // The length with the most queries is the best explanation.
  const CalibratedLength& length =
      *std::ranges::max_element(calibrated.lengths, {}, &CalibratedLength::queries);
  if (length.calibration.advice == CalibrationAdvice::no_right_recognition)
    return "no window is recognized correctly; check that the ground truth belongs to this query";
  return "at every setting that recognizes a window correctly, others are incorrect, or would be "
         "if their place were not trained";
}

}  // namespace vpr
