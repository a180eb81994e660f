#include "present/matrix_chart.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "present/result_text.h"
#include "truth/ground_truth.h"

namespace vpr {
namespace {

constexpr size_t kMostTicks = 10;
constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
constexpr size_t kSmallPixels = 300;  // per side of an image with small pixels
constexpr double kClipped = 0.01;     // share of the worst scores that are white

// A linear scale from the best score to the quantile of the worst ones; scores beyond are white,
// and missing ones transparent.
ChartImage gray_image(const PixelGrid& grid, const std::vector<double>& scores, bool is_distance,
                      const ScoreUnit& unit) {
  const cv::Size size(static_cast<int>(grid.cols), static_cast<int>(grid.rows));
  std::vector<double> values;
  for (const double score : scores)
    if (std::isfinite(score)) values.push_back(is_distance ? score : -score);
  if (values.empty()) return chart_image(cv::Mat(size, CV_8UC1, cv::Scalar::all(255)), grid.cells);
  const double best = std::ranges::min(values);
  const auto last = static_cast<ptrdiff_t>((1 - kClipped) * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + last, values.end());
  const double worst = values[static_cast<size_t>(last)];
  cv::Mat image(size, CV_8UC4);
  for (size_t p = 0; p < scores.size(); ++p) {
    const double value = is_distance ? scores[p] : -scores[p];
    const double share = worst > best ? std::clamp((value - best) / (worst - best), 0.0, 1.0) : 0.5;
    const auto gray = static_cast<uint8_t>(255 * (std::isnan(value) ? 0 : share));
    image.at<cv::Vec4b>(static_cast<int>(p / grid.cols), static_cast<int>(p % grid.cols)) =
        cv::Vec4b(gray, gray, gray, std::isnan(value) ? 0 : 255);
  }
  ChartImage drawn = chart_image(image, grid.cells);
  const double sign = is_distance ? 1 : -1;
  drawn.grays = {sign * best / unit.divisor, sign * worst / unit.divisor};
  drawn.gray_label =
      fmt::format("{}, from the best to the worst; the worst 1 % are clipped{}", unit.words,
                  values.size() < scores.size() ? "; tinted: no score" : "");
  return drawn;
}

// The ground truth as boxes of one pixel row each. In an image with small pixels, the outline
// leaves a pixel on both sides, so that it does not hide the scores.
Series truth_outline(const ScoreLayout& layout, const GroundTruth& truth, const PixelGrid& grid,
                     const Monitor& monitor) {
  Series outline = series_of(Meaning::truth_outline, SeriesStyle::outline);
  const size_t first_anchor = layout.anchor(0);
  const size_t outside = std::max(grid.rows, grid.cols) > kSmallPixels ? 3 * grid.cells : 0;
  for (size_t row = 0; row < row_count(layout); row += grid.cells)
    for (const ScoreLayout::Columns& columns : layout.columns) {
      check_stop(monitor);
      const size_t end_anchor = layout.anchor(columns.count);
      for (const LabelStretch& run :
           label_runs(truth, layout.anchor(row), columns.sequence, end_anchor)) {
        if (run.label != PlaceLabel::same || run.last < first_anchor) continue;
        const size_t first = std::max(run.first, first_anchor) - first_anchor;
        const size_t end = std::min(run.last + 1 - first_anchor + outside, columns.count);
        outline.points.emplace_back(columns.first + first - std::min(first, outside), row);
        outline.points.emplace_back(columns.first + end,
                                    std::min(row + grid.cells, row_count(layout)));
      }
    }
  return outline;
}

// Recognized cells as boxes of one pixel row each; the last cell of a pixel gives its meaning.
std::vector<Series> recognized_boxes(const Judgment& judgment, const GroundTruth& truth,
                                     const PixelGrid& grid, const Monitor& monitor) {
  const ScoreLayout& layout = judgment.layout;
  std::map<std::pair<size_t, size_t>, Meaning> pixels;  // by row and column
  const std::vector<FrameBand> columns = column_bands(layout);
  for (const MatchedFrame& one : judgment.recognized) {
    check_stop(monitor);
    pixels[{(one.query - layout.anchor(0)) / grid.cells,
            position_of(columns, one.match) / grid.cells}] =
        meaning_of(verdict_of(label_of(truth, one)));
  }
  std::vector<Series> all;
  const auto cells = static_cast<double>(grid.cells);
  for (const Meaning meaning : {Meaning::correct, Meaning::incorrect, Meaning::unjudged}) {
    Series& boxes = all.emplace_back(series_of(meaning, SeriesStyle::boxes));
    for (const auto& [pixel, found] : pixels) {
      if (found != meaning) continue;
      const auto row = static_cast<double>(pixel.first) * cells;
      const auto column = static_cast<double>(pixel.second) * cells;
      if (!boxes.points.empty() && boxes.points.back() == std::pair(column, row + cells))
        boxes.points.back().first += cells;  // continues the box to the left
      else
        boxes.points.insert(boxes.points.end(), {{column, row}, {column + cells, row + cells}});
    }
  }
  return all;
}

}  // namespace

std::vector<FrameBand> frame_bands(const ScoreLayout& layout) {
  std::vector<FrameBand> bands;
  for (const ScoreLayout::Columns& columns : layout.columns) {
    const Sequence& sequence = layout.scope.sequences[columns.sequence].sequence;
    bands.push_back({sequence.name, columns.sequence, length_of(bands), 0, sequence.frames});
  }
  return bands;
}

std::vector<FrameBand> column_bands(const ScoreLayout& layout) {
  std::vector<FrameBand> bands;
  for (const ScoreLayout::Columns& columns : layout.columns)
    bands.push_back({layout.scope.sequences[columns.sequence].sequence.name, columns.sequence,
                     columns.first, layout.anchor(0), columns.count});
  return bands;
}

std::vector<FrameBand> row_bands(const ScoreLayout& layout) {
  return {{"", 0, 0, layout.anchor(0), row_count(layout)}};
}

size_t length_of(const std::vector<FrameBand>& bands) {
  return bands.empty() ? 0 : bands.back().at + bands.back().count;
}

size_t position_of(const std::vector<FrameBand>& bands, const FrameMatch& match) {
  const auto band = std::ranges::lower_bound(bands, match.sequence, {}, &FrameBand::sequence);
  assert(band != bands.end() && band->sequence == match.sequence);
  return band->at + match.reference - band->first;
}

std::vector<ChartTick> ticks_of(const std::vector<FrameBand>& bands, size_t most) {
  const size_t step = round_step(length_of(bands), most);
  std::vector<ChartTick> ticks;
  double end = -1e9;  // of the previous label
  const double room = static_cast<double>(step) * 0.45;
  for (const FrameBand& band : bands) {
    const size_t behind = band.first + band.count;
    for (size_t frame = band.first; frame < behind; frame = (frame / step + 1) * step) {
      const size_t at = band.at + frame - band.first;
      const double position = static_cast<double>(at) + 0.5;
      if (position < end) {
        if (frame > band.first) continue;
        ticks.pop_back();
      }
      ticks.push_back({position, std::to_string(frame)});
      end = position + room;
    }
  }
  return ticks;
}

ChartAxis frame_axis(const std::vector<FrameBand>& bands, const std::string& label, bool is_down) {
  ChartAxis axis{label};
  const double end = std::max<double>(1, static_cast<double>(length_of(bands)));
  axis.range = is_down ? std::pair(end, 0.0) : std::pair(0.0, end);
  axis.ticks = ticks_of(bands, kMostTicks);
  if (bands.size() == 1) {
    if (!bands[0].name.empty() && label.ends_with("frame")) axis.label += " of " + bands[0].name;
    return axis;
  }
  for (const FrameBand& band : bands)
    axis.bands.push_back({static_cast<double>(band.at), band.name});
  return axis;
}

PixelGrid::PixelGrid(const ScoreLayout& layout, size_t most_pixels) {
  const size_t height = std::max<size_t>(1, row_count(layout));
  const size_t width = std::max<size_t>(1, column_count(layout));
  cells = (std::max(height, width) + most_pixels - 1) / most_pixels;
  rows = (height + cells - 1) / cells;
  cols = (width + cells - 1) / cells;
}

RowPixels::RowPixels(const ScoreLayout& layout, size_t most_pixels)
    : layout_(layout), grid_(layout, most_pixels), closest_(grid_.rows * grid_.cols) {
  for (auto& value : closest_) value = kNone;
}

void RowPixels::operator()(const ScoreRow& row) {
  const size_t first = layout_.columns_of(static_cast<uint32_t>(row.sequence))->first;
  for (size_t i = 0; i < row.scores.size();) {
    const size_t column = first + row.train_window + i;
    const size_t next = (column / grid_.cells + 1) * grid_.cells - column;  // pixel
    const size_t end = std::min(row.scores.size(), i + next);
    const auto begin = row.scores.begin();
    const uint32_t closest =
        *std::min_element(begin + static_cast<ptrdiff_t>(i), begin + static_cast<ptrdiff_t>(end));
    std::atomic<uint32_t>& pixel = closest_[grid_.index(row.query_window, column)];
    uint32_t seen = pixel.load(std::memory_order_relaxed);
    while (closest < seen && !pixel.compare_exchange_weak(seen, closest)) {
    }
    i = end;
  }
}

std::vector<double> RowPixels::scores(int64_t offset) const {
  std::vector<double> scores;
  for (const auto& value : closest_)
    scores.push_back(value == kNone ? std::numeric_limits<double>::quiet_NaN()
                                    : static_cast<double>(int64_t{value} - offset));
  return scores;
}

std::vector<double> pixel_scores(const ScoreMatrix& matrix, const PixelGrid& grid,
                                 const Monitor& monitor) {
  std::vector<uint64_t> best(grid.rows * grid.cols, kNoScore);
  matrix.for_each_row(1, monitor, "drawing scores",
                      [&](size_t, size_t row, std::span<const uint64_t> keys) {
                        uint64_t* line = &best[grid.index(row, 0)];
                        for (size_t c = 0; c < keys.size(); ++c)
                          line[c / grid.cells] = std::min(line[c / grid.cells], keys[c]);
                      });
  std::vector<double> scores;
  for (const uint64_t key : best) scores.push_back(score_of_key(key, matrix.kind));
  return scores;
}

ScoreUnit score_unit(const QuerySettings& settings, size_t window_length) {
  const ScoreKind& kind = score_of(settings);
  if (kind.frame_value == nullptr) return {std::string(kind.measure)};
  const double divisor = 1 / kind.frame_value(1, window_length);
  if (has_paths(settings)) return {"path score in deviations", divisor};
  return {fmt::format("{}{}", window_length > 1 ? "mean " : "", kind.measure), divisor};
}

Chart matrix_chart(const Judgment& judgment, const GroundTruth& truth, const PixelGrid& grid,
                   const std::vector<double>& scores, const std::string& reference,
                   const ScoreUnit& unit, const Monitor& monitor) {
  const ScoreLayout& layout = judgment.layout;
  Chart chart{"matrix", ""};
  chart.x = frame_axis(column_bands(layout), reference, false);
  chart.y = frame_axis(row_bands(layout), "query frame, downwards", true);
  chart.image = gray_image(grid, scores, judgment.outcomes.kind == ScoreOrder::distance, unit);
  chart.series = recognized_boxes(judgment, truth, grid, monitor);
  chart.series.insert(chart.series.begin(), truth_outline(layout, truth, grid, monitor));
  erase_empty_series(chart);
  name_borders(chart);
  chart.width = 1320;  // the largest image and its labels
  return chart;
}

Chart result_matrix_chart(const Result& result, const RowPixels& pixels, const Monitor& monitor) {
  const GroundTruth unknown = unknown_ground_truth(scope_of(result));
  const Judgment judgment = judge(result, unknown, {}, monitor);
  Chart chart =
      matrix_chart(judgment, unknown, pixels.grid(),
                   pixels.scores(result.score().offset(result.window_length())), "training frame",
                   score_unit(result.settings, result.window_length()), monitor);
  chart.title = fmt::format("{} on {}, c_l {}", method_text(result.settings), result.query.name,
                            result.window_length());
  return chart;
}

}  // namespace vpr
