// Charts of sweeps: heat maps, and correct against incorrect recognitions.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "present/chart.h"
#include "tune/sweep_report.h"

namespace vpr {
namespace {

constexpr double kLogZero = 0.3;  // the position of 0 on a logarithmic axis

/// A name per unit.
ChartAxis name_axis(std::string_view label, const std::vector<std::string>& names, bool is_down) {
  ChartAxis axis{std::string(label)};
  const auto end = static_cast<double>(names.size());
  axis.range = is_down ? std::pair(end, 0.0) : std::pair(0.0, end);
  for (size_t i = 0; i < names.size(); ++i)
    axis.ticks.push_back({static_cast<double>(i) + 0.5, names[i]});
  return axis;
}

// Cells fill an image of about 560 x 480 units, and have room for a count.
ChartImage cells_image(const cv::Mat& cells) {
  const int width = std::max(56, 560 / cells.cols);
  const int height = std::max(22, 480 / cells.rows);
  cv::Mat large;
  cv::resize(cells, large, {}, width, height, cv::INTER_NEAREST);
  return {png_of(large), static_cast<size_t>(large.cols), static_cast<size_t>(large.rows),
          static_cast<double>(cells.cols), static_cast<double>(cells.rows)};
}

// Counts frames, as the printed table.
Chart heat_chart(const Sweep& sweep, const std::string& what, uint64_t Localization::*count,
                 Meaning meaning) {
  const auto windows = distinct_texts(sweep, window_text);
  const auto thresholds = distinct_texts(sweep, threshold_text);
  Chart chart{"heat-map", fmt::format("{}: {}", sweep.query.name, what)};
  chart.x = name_axis(sweep.score->window_symbol, windows, false);
  chart.y = name_axis(sweep.threshold_symbol, thresholds, true);
  uint64_t most = 1;
  for (const CellCounts& cell : sweep.cells) most = std::max(most, cell.path.*count);
  cv::Mat image(static_cast<int>(thresholds.size()), static_cast<int>(windows.size()), CV_8UC3,
                cv::Scalar::all(255));
  Series numbers{"", {}, SeriesStyle::points, meaning, SeriesMark::none};
  for (const CellCounts& cell : sweep.cells) {
    const auto x = std::ranges::find(windows, window_text(cell)) - windows.begin();
    const auto y = std::ranges::find(thresholds, threshold_text(cell)) - thresholds.begin();
    const uint64_t frames = cell.path.*count;
    // From white to the full color, by the square root of the share in the largest count.
    const double share = std::sqrt(static_cast<double>(frames) / static_cast<double>(most));
    cv::Vec3b& pixel = image.at<cv::Vec3b>(static_cast<int>(y), static_cast<int>(x));
    const cv::Vec3b full = bgr_of(meaning);
    for (int c = 0; c < 3; ++c) pixel[c] = static_cast<uint8_t>(255 + share * (full[c] - 255));
    numbers.points.emplace_back(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
    numbers.labels.push_back(short_count(frames));
  }
  chart.series = {numbers};
  chart.image = cells_image(image);
  return chart;
}

}  // namespace

std::string short_count(uint64_t count) {
  if (count < 1000) return std::to_string(count);
  const bool is_thousands = count < 999'500;
  const double value = static_cast<double>(count) / (is_thousands ? 1e3 : 1e6);
  return fmt::format("{:.{}f}{}", value, value < 9.95 ? 1 : 0, is_thousands ? 'k' : 'M');
}

Chart sweep_chart(const Sweep& sweep) {
  Chart chart{"correct-incorrect",
              fmt::format("{}: recognitions", sweep.query.name),
              {"incorrect recognitions"}};
  chart.y.label = "correct recognitions";
  double most = 1;
  for (const CellCounts& cell : sweep.cells)
    most = std::max(most, static_cast<double>(cell.counts.recognitions.incorrect));
  chart.x.is_log = true;  // with 0 below 1
  chart.x.range = {kLogZero, 2 * most};
  chart.x.ticks = {{kLogZero, "0"}};
  for (double power = 1; power <= 2 * most; power *= 10)
    chart.x.ticks.push_back({power, fmt::format("{:g}", power)});
  const auto looseness = [&](const CellCounts* cell) {
    return looseness_of(*cell, sweep.threshold_order);
  };
  for (const std::string& window : distinct_texts(sweep, window_text)) {
    Series series{fmt::format("{} {}", sweep.score->window_symbol, window), {}};
    std::vector<const CellCounts*> order;
    for (const CellCounts& cell : sweep.cells)
      if (window_text(cell) == window) order.push_back(&cell);
    // From the strictest threshold to the loosest; automatic ones have no order and stand alone.
    std::ranges::stable_sort(order, {}, [&](const CellCounts* cell) {
      const auto known = looseness(cell);
      return std::pair(!known, known);
    });
    for (const CellCounts* cell : order) {
      if (!looseness(cell) && !series.points.empty()) {
        series.points.push_back(kChartGap);
        series.labels.emplace_back();
      }
      series.points.emplace_back(
          std::max(kLogZero, static_cast<double>(cell->counts.recognitions.incorrect)),
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
        heat_chart(sweep, "frames recognized correctly", &Localization::correct, Meaning::correct));
    charts.push_back(heat_chart(sweep, "frames recognized incorrectly", &Localization::incorrect,
                                Meaning::incorrect));
  }
  return chart_png(charts, 2);
}

}  // namespace vpr
