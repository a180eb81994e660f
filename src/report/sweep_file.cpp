#include "report/sweep_file.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/json.h"
#include "report/palette.h"

namespace vpr {
namespace {

Json labels_json(const LabelCounts& counts) {
  return {
      {"correct", counts.correct}, {"incorrect", counts.incorrect}, {"ignored", counts.ignored}};
}

Json cell_json(const SequenceCellCounts& cell) {
  return {{"c_l", cell.window_length},
          {"t_r", cell.distance_threshold ? Json(*cell.distance_threshold) : Json("auto")},
          {"t_r_scale", enum_name(cell.scale)},
          {"counts",
           {{"hits", labels_json(cell.counts.hits)},
            {"places", labels_json(cell.counts.places)},
            {"distinct", cell.counts.distinct}}},
          {"best_match",
           {{"queries", cell.counts.best_match.queries},
            {"correct", cell.counts.best_match.correct},
            {"ignored", cell.counts.best_match.ignored}}}};
}

Json cell_json(const FabmapCellCounts& cell) {
  return {{"c_w", cell.window},
          {"t_p", cell.place_threshold},
          {"counts", {{"hits", labels_json(cell.counts.hits)}, {"distinct", cell.counts.distinct}}},
          {"best_match",
           {{"queries", cell.counts.best_match.queries},
            {"correct", cell.counts.best_match.correct},
            {"ignored", cell.counts.best_match.ignored}}}};
}

/// One cell of either kind, as tables and pictures show it.
struct GridCell {
  std::string window;
  std::string threshold;
  uint64_t correct = 0;  ///< places, or recognitions of FAB-MAP
  uint64_t incorrect = 0;
};

std::string number(double value) { return fmt::format("{}", value); }

std::vector<GridCell> grid_cells(const Sweep& sweep) {
  std::vector<GridCell> cells;
  for (const SequenceCellCounts& cell : sweep.sequence_cells)
    cells.push_back({std::to_string(cell.window_length),
                     cell.distance_threshold ? number(*cell.distance_threshold) : "auto",
                     cell.counts.places.correct, cell.counts.places.incorrect});
  for (const FabmapCellCounts& cell : sweep.fabmap_cells)
    cells.push_back({std::to_string(cell.window), number(cell.place_threshold),
                     cell.counts.hits.correct, cell.counts.hits.incorrect});
  return cells;
}

bool is_fabmap(const Sweep& sweep) { return !sweep.fabmap_cells.empty(); }

// Values in the order in which they first come.
std::vector<std::string> distinct_values(const std::vector<GridCell>& cells,
                                         std::string GridCell::*value) {
  std::vector<std::string> values;
  for (const GridCell& cell : cells)
    if (std::find(values.begin(), values.end(), cell.*value) == values.end())
      values.push_back(cell.*value);
  return values;
}

std::string cell_name(const Sweep& sweep, size_t index) {
  const GridCell cell = grid_cells(sweep)[index];
  if (is_fabmap(sweep)) return fmt::format("c_w {}, t_p {}", cell.window, cell.threshold);
  return fmt::format("c_l {}, t_r {} ({})", cell.window, cell.threshold,
                     enum_name(sweep.sequence_cells[index].scale));
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
               {"reason", choice.reason},
               {"nearest_error", index(choice.nearest_error)}};
  json["pareto"] = Json::array();
  for (const size_t cell : choice.pareto) json["pareto"].push_back(first + cell);
  if (sweep.intervals) {
    json["intervals"] = {{"block", sweep.intervals->block},
                         {"correct_hits", interval_json(sweep.intervals->correct_hits)},
                         {"incorrect_hits", interval_json(sweep.intervals->incorrect_hits)}};
    if (!is_fabmap(sweep)) {
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

Table sweep_table(const std::vector<Sweep>& sweeps) {
  Table table;
  const bool fabmap = is_fabmap(sweeps.front());
  table.title = fabmap ? "Recognitions by c_w, right and wrong" : "Places by c_l, right and wrong";
  const auto windows = distinct_values(grid_cells(sweeps.front()), &GridCell::window);
  table.columns = {"sequence", fabmap ? "t_p" : "t_r"};
  for (const std::string& window : windows)
    table.columns.insert(table.columns.end(), {window + " right", "wrong"});
  for (const Sweep& sweep : sweeps) {
    const std::vector<GridCell> cells = grid_cells(sweep);
    for (const std::string& threshold : distinct_values(cells, &GridCell::threshold)) {
      std::vector<std::string>& row = table.rows.emplace_back();
      row = {sweep.query_name, threshold};
      for (const GridCell& cell : cells)
        if (cell.threshold == threshold)
          row.insert(row.end(), {std::to_string(cell.correct), std::to_string(cell.incorrect)});
    }
  }
  return table;
}

std::string recommendation_text(const Sweep& sweep) {
  const Recommendation& choice = sweep.recommendation;
  if (!choice.cell)
    return fmt::format("{}: no recommendation: {}.\n", sweep.query_name, choice.reason);
  std::string text = fmt::format("{}: recommended: {}: {}.\n", sweep.query_name,
                                 cell_name(sweep, *choice.cell), choice.reason);
  text += choice.nearest_error
              ? fmt::format("The nearest setting of this window with an error is {}.\n",
                            cell_name(sweep, *choice.nearest_error))
              : "No setting of this window in the grid has an error.\n";
  if (sweep.intervals && !is_fabmap(sweep))
    text +=
        fmt::format("Correct places {:.0f} to {:.0f}, incorrect {:.0f} to {:.0f}. ",
                    sweep.intervals->correct_places.low, sweep.intervals->correct_places.high,
                    sweep.intervals->incorrect_places.low, sweep.intervals->incorrect_places.high);
  if (sweep.intervals)
    text += fmt::format(
        "Correct hits {:.0f} to {:.0f}, incorrect {:.0f} to {:.0f} (95 %, blocks of "
        "{} frames).\n",
        sweep.intervals->correct_hits.low, sweep.intervals->correct_hits.high,
        sweep.intervals->incorrect_hits.low, sweep.intervals->incorrect_hits.high,
        sweep.intervals->block);
  return text;
}

Plot sweep_plot(const Sweep& sweep) {
  const std::vector<GridCell> cells = grid_cells(sweep);
  Plot plot;
  plot.file = "correct-incorrect";
  plot.title = fmt::format("{}: {}", sweep.query_name,
                           is_fabmap(sweep) ? "recognitions" : "recognised places");
  plot.x_label = "incorrect";
  plot.y_label = "correct";
  plot.starts_at_zero = true;
  for (const std::string& window : distinct_values(cells, &GridCell::window)) {
    PlotLine line{fmt::format("{} {}", is_fabmap(sweep) ? "c_w" : "c_l", window), {}};
    std::vector<const GridCell*> order;
    for (const GridCell& cell : cells)
      if (cell.window == window) order.push_back(&cell);
    std::stable_sort(order.begin(), order.end(), [](const GridCell* a, const GridCell* b) {
      return std::pair(a->incorrect, a->correct) < std::pair(b->incorrect, b->correct);
    });
    for (const GridCell* cell : order) {
      line.points.emplace_back(static_cast<double>(cell->incorrect),
                               static_cast<double>(cell->correct));
      line.labels.push_back((is_fabmap(sweep) ? "t_p " : "t_r ") + cell->threshold);
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
  const std::vector<GridCell> cells = grid_cells(sweep);
  const auto windows = distinct_values(cells, &GridCell::window);
  const auto thresholds = distinct_values(cells, &GridCell::threshold);
  const int panel = kMargin + static_cast<int>(windows.size()) * kCellWidth + 20;
  cv::Mat canvas(kMargin + static_cast<int>(thresholds.size()) * kCellHeight + 20,
                 std::max(2 * panel, 480), CV_8UC3, cv::Scalar(255, 255, 255));
  const auto write = [&](const std::string& text, int x, int y, const cv::Scalar& colour) {
    cv::putText(canvas, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.45, colour, 1, cv::LINE_AA);
  };
  const auto draw = [&](const char* title, uint64_t GridCell::*count, int left,
                        const cv::Scalar& full) {
    uint64_t most = 1;
    for (const GridCell& cell : cells) most = std::max(most, cell.*count);
    write(sweep.query_name + ": " + title, left + kMargin, 20, {0, 0, 0});
    for (size_t w = 0; w < windows.size(); ++w)
      write((is_fabmap(sweep) ? "c_w " : "c_l ") + windows[w],
            left + kMargin + static_cast<int>(w) * kCellWidth + 4, kMargin - 10, {0, 0, 0});
    for (size_t t = 0; t < thresholds.size(); ++t)
      write(thresholds[t], left + 8, kMargin + static_cast<int>(t) * kCellHeight + 23, {0, 0, 0});
    for (const GridCell& cell : cells) {
      const auto w = std::find(windows.begin(), windows.end(), cell.window) - windows.begin();
      const auto t =
          std::find(thresholds.begin(), thresholds.end(), cell.threshold) - thresholds.begin();
      const double share = std::sqrt(static_cast<double>(cell.*count) / static_cast<double>(most));
      cv::Scalar colour;
      for (int c = 0; c < 3; ++c) colour[c] = 255 + share * (full[c] - 255);
      const cv::Rect box(left + kMargin + static_cast<int>(w) * kCellWidth,
                         kMargin + static_cast<int>(t) * kCellHeight, kCellWidth - 2,
                         kCellHeight - 2);
      cv::rectangle(canvas, box, colour, cv::FILLED);
      write(std::to_string(cell.*count), box.x + 6, box.y + 22,
            share > 0.7 ? cv::Scalar(255, 255, 255) : cv::Scalar(40, 40, 40));
    }
  };
  draw("correct", &GridCell::correct, 0, bgr_of(Meaning::right));
  draw("incorrect", &GridCell::incorrect, panel, bgr_of(Meaning::wrong));
  return canvas;
}

}  // namespace

cv::Mat draw_sweeps(const std::vector<Sweep>& sweeps) {
  cv::Mat all;
  for (const Sweep& sweep : sweeps) all.push_back(draw_grid(sweep));
  return all;
}

}  // namespace vpr
