#include "report/sweep_file.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/json.h"
#include "report/evaluation_report.h"
#include "report/palette.h"
#include "report/sweep_table.h"

namespace vpr {
namespace {

Json best_json(const BestMatchCounts& best) {
  return {{"queries", best.queries}, {"correct", best.correct}, {"ignored", best.ignored}};
}

Json cell_json(const SequenceCellCounts& cell) {
  return {{"c_l", cell.window_length},
          {"t_r", cell.distance_threshold ? Json(*cell.distance_threshold) : Json("auto")},
          {"t_r_scale", enum_name(cell.scale)},
          {"counts", counts_json(cell.counts)},
          {"best_match", best_json(cell.counts.best_match)}};
}

Json cell_json(const FabmapCellCounts& cell) {
  return {{"c_w", cell.window},
          {"t_p", cell.place_threshold},
          {"counts", counts_json(cell.counts)},
          {"best_match", best_json(cell.counts.best_match)}};
}

Json interval_json(const Interval& interval) { return {interval.low, interval.high}; }

// `first`: the index of the sweep's first cell among those of all sweeps.
Json choice_json(const Sweep& sweep, size_t first) {
  const Recommendation& choice = sweep.recommendation;
  const auto index = [&](const std::optional<size_t>& cell) {
    return cell ? Json(first + *cell) : Json();
  };
  Json json = {{"name", sweep.query_name},
               {"ground_truth", sweep.protocol},
               {"recommended", index(choice.cell)},
               {"recommended_settings", sweep.recommended_settings.value_or(Json())},
               {"advice", enum_name(choice.advice)},
               {"reason", reason_text(sweep)},
               {"near_miss", index(choice.near_miss)},
               {"nearest_error", index(choice.first_error)}};
  json["pareto"] = Json::array();
  for (const size_t cell : choice.pareto) json["pareto"].push_back(first + cell);
  if (sweep.intervals) {
    json["intervals"] = {{"block", sweep.intervals->block},
                         {"correct_hits", interval_json(sweep.intervals->correct_hits)},
                         {"incorrect_hits", interval_json(sweep.intervals->incorrect_hits)}};
    if (!sweep.sequence_cells.empty()) {
      json["intervals"]["correct_places"] = interval_json(sweep.intervals->correct_places);
      json["intervals"]["incorrect_places"] = interval_json(sweep.intervals->incorrect_places);
    }
  }
  if (sweep.validation) json["validation"] = *sweep.validation;
  return json;
}

}  // namespace

void add_sweeps(Json& json, const std::vector<Sweep>& sweeps) {
  json["cells"] = Json::array();
  json["queries"] = Json::array();
  for (const Sweep& sweep : sweeps) {
    json["queries"].push_back(choice_json(sweep, json["cells"].size()));
    const auto add = [&](Json cell) {
      Json named = {{"query", sweep.query_name}};
      named.update(cell);
      json["cells"].push_back(named);
    };
    for (const auto& cell : sweep.sequence_cells) add(cell_json(cell));
    for (const auto& cell : sweep.fabmap_cells) add(cell_json(cell));
  }
}

Plot sweep_plot(const Sweep& sweep) {
  const std::vector<SweepCell> cells = sweep_cells(sweep);
  Plot plot;
  plot.file = "correct-incorrect";
  plot.title = fmt::format("{}: hits", sweep.query_name);
  plot.x_label = "incorrect hits";
  plot.y_label = "correct hits";
  plot.starts_at_zero = true;
  const SweepSymbols symbols = sweep_symbols(sweep);
  for (const std::string& window : distinct_values(cells, &SweepCell::window)) {
    PlotLine line{fmt::format("{} {}", symbols.window, window), {}};
    std::vector<const SweepCell*> order;
    for (const SweepCell& cell : cells)
      if (cell.window == window) order.push_back(&cell);
    // From the strictest threshold to the loosest; automatic ones have no order and stand alone.
    std::stable_sort(order.begin(), order.end(), [](const SweepCell* a, const SweepCell* b) {
      return a->looseness.has_value() != b->looseness.has_value() ? a->looseness.has_value()
                                                                  : a->looseness < b->looseness;
    });
    for (const SweepCell* cell : order) {
      if (!cell->looseness && !line.points.empty()) {
        line.points.push_back(kPlotGap);
        line.labels.emplace_back();
      }
      line.points.emplace_back(static_cast<double>(cell->hits.incorrect),
                               static_cast<double>(cell->hits.correct));
      line.labels.push_back(symbols.threshold + " " + cell->threshold);
    }
    plot.lines.push_back(line);
  }
  thin_labels(plot);
  return plot;
}

namespace {

cv::Mat draw_grid(const Sweep& sweep) {
  constexpr int kCellWidth = 64;
  constexpr int kCellHeight = 36;
  constexpr int kMargin = 70;
  const std::vector<SweepCell> cells = sweep_cells(sweep);
  const auto windows = distinct_values(cells, &SweepCell::window);
  const auto thresholds = distinct_values(cells, &SweepCell::threshold);
  const int panel = kMargin + static_cast<int>(windows.size()) * kCellWidth + 20;
  cv::Mat canvas(kMargin + static_cast<int>(thresholds.size()) * kCellHeight + 20,
                 std::max(2 * panel, 480), CV_8UC3, cv::Scalar(255, 255, 255));
  const auto write = [&](const std::string& text, int x, int y, const cv::Scalar& colour) {
    cv::putText(canvas, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.45, colour, 1, cv::LINE_AA);
  };
  const auto draw = [&](const char* title, uint64_t LabelCounts::*count, int left,
                        const cv::Scalar& full) {
    uint64_t most = 1;
    for (const SweepCell& cell : cells) most = std::max(most, cell.hits.*count);
    write(sweep.query_name + ": " + title, left + kMargin, 20, {0, 0, 0});
    for (size_t w = 0; w < windows.size(); ++w)
      write(sweep_symbols(sweep).window + " " + windows[w],
            left + kMargin + static_cast<int>(w) * kCellWidth + 4, kMargin - 10, {0, 0, 0});
    for (size_t t = 0; t < thresholds.size(); ++t)
      write(thresholds[t], left + 8, kMargin + static_cast<int>(t) * kCellHeight + 23, {0, 0, 0});
    for (const SweepCell& cell : cells) {
      const auto w = std::find(windows.begin(), windows.end(), cell.window) - windows.begin();
      const auto t =
          std::find(thresholds.begin(), thresholds.end(), cell.threshold) - thresholds.begin();
      const double share =
          std::sqrt(static_cast<double>(cell.hits.*count) / static_cast<double>(most));
      cv::Scalar colour;
      for (int c = 0; c < 3; ++c) colour[c] = 255 + share * (full[c] - 255);
      const cv::Rect box(left + kMargin + static_cast<int>(w) * kCellWidth,
                         kMargin + static_cast<int>(t) * kCellHeight, kCellWidth - 2,
                         kCellHeight - 2);
      cv::rectangle(canvas, box, colour, cv::FILLED);
      write(std::to_string(cell.hits.*count), box.x + 6, box.y + 22,
            share > 0.7 ? cv::Scalar(255, 255, 255) : cv::Scalar(40, 40, 40));
    }
  };
  draw("correct hits", &LabelCounts::correct, 0, bgr_of(Meaning::right));
  draw("incorrect hits", &LabelCounts::incorrect, panel, bgr_of(Meaning::wrong));
  return canvas;
}

}  // namespace

cv::Mat draw_sweeps(const std::vector<Sweep>& sweeps) {
  cv::Mat all;
  for (const Sweep& sweep : sweeps) all.push_back(draw_grid(sweep));
  return all;
}

}  // namespace vpr
