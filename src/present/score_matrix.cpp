#include "present/score_matrix.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/json.h"
#include "base/npy.h"
#include "base/output.h"
#include "base/statistics.h"
#include "present/chart.h"
#include "present/result_file.h"
#include "truth/ground_truth.h"

namespace vpr {
namespace {

constexpr size_t kMostTicks = 10;
constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
const cv::Vec3b kNoScoreColor(235, 225, 215);

/// Returns the scores of black and white.
std::optional<std::pair<double, double>> draw_gray(cv::Mat& image,
                                                   const std::vector<double>& scores,
                                                   bool is_distance) {
  std::vector<double> values;
  for (const double score : scores)
    if (std::isfinite(score)) values.push_back(score);
  if (values.empty()) return std::nullopt;
  const double low = quantile(values, 0.01);
  const double high = quantile(values, 0.99);
  for (size_t p = 0; p < scores.size(); ++p) {
    cv::Vec3b& pixel = image.at<cv::Vec3b>(static_cast<int>(p / static_cast<size_t>(image.cols)),
                                           static_cast<int>(p % static_cast<size_t>(image.cols)));
    if (std::isnan(scores[p])) {
      pixel = kNoScoreColor;
      continue;
    }
    const double share = high > low ? std::clamp((scores[p] - low) / (high - low), 0.0, 1.0) : 0.5;
    const auto gray = static_cast<uint8_t>(255 * (is_distance ? share : 1 - share));
    pixel = cv::Vec3b(gray, gray, gray);
  }
  return is_distance ? std::pair(low, high) : std::pair(high, low);
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
  return band->at + match.reference - band->first_frame;
}

std::vector<ChartTick> ticks_of(const std::vector<FrameBand>& bands, size_t most) {
  const size_t step = round_step(length_of(bands), most);
  std::vector<ChartTick> ticks;
  double end = -1e9;  // of the previous label
  const double room = static_cast<double>(step) * 0.45;
  for (const FrameBand& band : bands) {
    const size_t behind = band.first_frame + band.count;
    for (size_t frame = band.first_frame; frame < behind; frame = (frame / step + 1) * step) {
      const size_t at = band.at + frame - band.first_frame;
      const double position = static_cast<double>(at) + 0.5;
      if (position < end) {
        if (frame > band.first_frame) continue;
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
  for (const FrameBand& band : bands)
    if (!band.name.empty()) axis.bands.push_back({static_cast<double>(band.at), band.name});
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
  for (const uint64_t key : best) scores.push_back(score_of_key(key, matrix.kind()));
  return scores;
}

Chart matrix_chart(const Judgment& judgment, const GroundTruth& truth, const PixelGrid& grid,
                   const std::vector<double>& scores, const MatrixWords& words,
                   const Monitor& monitor) {
  const ScoreLayout& layout = judgment.layout;
  cv::Mat image(static_cast<int>(grid.rows), static_cast<int>(grid.cols), CV_8UC3,
                cv::Scalar::all(255));
  const auto grays = draw_gray(image, scores, judgment.outcomes.kind == ScoreOrder::distance);
  std::set<Meaning> shown;
  const auto set = [&](size_t row, size_t column, Meaning meaning) {
    image.at<cv::Vec3b>(static_cast<int>(row / grid.cells), static_cast<int>(column / grid.cells)) =
        bgr_of(meaning);
    shown.insert(meaning);
  };
  const size_t first_anchor = layout.anchor(0);
  for (size_t row = 0; row < row_count(layout); ++row)
    for (const ScoreLayout::Columns& columns : layout.columns) {
      check_stop(monitor);
      const size_t end_anchor = layout.anchor(columns.count);
      for (const LabelRun& run :
           label_runs(truth, layout.anchor(row), columns.sequence, end_anchor)) {
        if (run.label != PlaceLabel::same || run.last < first_anchor) continue;
        const size_t end = columns.first + run.last - first_anchor + 1;
        for (size_t column = columns.first + std::max(run.first, first_anchor) - first_anchor;
             column < end; column = (column / grid.cells + 1) * grid.cells)
          set(row, column, Meaning::truth);
      }
    }
  for (const ScoreLayout::Columns& columns : layout.columns)
    if (columns.first > 0)
      image.col(static_cast<int>(columns.first / grid.cells)).setTo(bgr_of(Meaning::divider));
  for (const RecognizedCell& cell : judgment.recognized) {
    check_stop(monitor);
    const FrameMatch match = match_of_column(layout, cell.column);
    set(cell.query_window, cell.column,
        meaning_of(truth.label(layout.anchor(cell.query_window), match.sequence, match.reference)));
  }
  Chart chart{"matrix", ""};
  chart.x = frame_axis(column_bands(layout), words.reference, false);
  chart.y = frame_axis(row_bands(layout), "query frame, downwards", true);
  chart.image = chart_image(image, grid.cells);
  chart.image->grays = grays;
  chart.image->gray_label = words.score;
  for (const Meaning meaning : shown)
    chart.series.push_back(series_of(meaning, SeriesStyle::points, SeriesMark::square));
  return chart;
}

Chart result_matrix_chart(const Result& result, const RowPixels& pixels, const GroundTruth* truth,
                          const Monitor& monitor) {
  const GroundTruth known = truth != nullptr ? *truth : unknown_ground_truth(scope_of(result));
  const Judgment judgment = judge(result, known, {}, monitor);
  Chart chart = matrix_chart(judgment, known, pixels.grid(),
                             pixels.scores(result.score().offset(result.window_length())),
                             {"training frame", std::string(result.score().title)}, monitor);
  chart.title = fmt::format("{} on {}, c_l {}", method_of(result.settings), result.query.name,
                            result.window_length());
  return chart;
}

Json matrix_layout_json(const ScoreLayout& layout) {
  Json sequences = Json::array();
  size_t column = 0;
  for (uint32_t s = 0; s < layout.scope.sequences.size(); ++s) {
    if (!layout.scope.sequences[s].searched) continue;
    sequences.push_back(
        {{"sequence", layout.scope.sequences[s].sequence.name}, {"first_column", column}});
    if (const ScoreLayout::Columns* columns = layout.columns_of(s)) column += columns->count;
  }
  return {{"rows", row_count(layout)}, {"columns", column}, {"sequences", sequences}};
}

MatrixFile::MatrixFile(Output& file, const Result& result, bool has_gaps, const Monitor& monitor)
    : file_(file),
      layout_(layout_of(result)),
      score_offset_(result.score().offset(result.window_length())) {
  const size_t rows = row_count(layout_);
  const size_t columns = column_count(layout_);
  const std::string header = npy_header(npy_type<int32_t>(), {rows, columns});
  header_bytes_ = header.size();
  file_.write(header);
  file_.reserve(header_bytes_ + sizeof(int32_t) * rows * columns);
  if (!has_gaps) return;
  const std::vector<int32_t> missing(columns, result.score().missing);
  for (size_t r = 0; r < rows; ++r) {
    check_stop(monitor);
    file_.write(std::as_bytes(std::span(missing)));
  }
}

void MatrixFile::operator()(const ScoreRow& row) {
  const size_t first = layout_.columns_of(static_cast<uint32_t>(row.sequence))->first;
  const size_t cell = row.query_window * column_count(layout_) + first + row.train_window;
  const size_t position = header_bytes_ + sizeof(int32_t) * cell;
  if (score_offset_ == 0) {
    file_.write_at(position, std::as_bytes(row.scores));
    return;
  }
  std::vector<int32_t> scores(row.scores.size());
  std::transform(row.scores.begin(), row.scores.end(), scores.begin(),
                 [&](uint32_t sum) { return static_cast<int32_t>(sum - score_offset_); });
  file_.write_at(position, std::as_bytes(std::span(scores)));
}

Json MatrixFile::entry(const Monitor& monitor) const {
  return file_entry(file_.temporary(), row_count(layout_), monitor);
}

PosteriorFile::PosteriorFile(Output& file, size_t frames, size_t views)
    : file_(file), frames_(frames), columns_(views + 1) {
  file_.write(npy_header(npy_type<double>(), {frames, columns_}));
}

void PosteriorFile::add(std::span<const double> posterior) {
  std::vector<double> row(posterior.begin(), posterior.end());
  row.resize(columns_, posterior.empty() ? std::numeric_limits<double>::quiet_NaN() : 0);
  file_.write(std::as_bytes(std::span<const double>(row)));
}

Json PosteriorFile::entry(const Monitor& monitor) const {
  return file_entry(file_.temporary(), frames_, monitor);
}

}  // namespace vpr
