#include "report/score_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <opencv2/core/mat.hpp>

#include "base/statistics.h"
#include "ground_truth/ground_truth.h"

namespace vpr {
namespace {

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
const cv::Vec3b kNoScoreColour(235, 225, 215);

std::vector<double> scores_of(const ScoreMatrix& matrix, const PixelGrid& grid,
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

/// Gives the scores of black and white.
std::optional<std::pair<double, double>> draw_grey(cv::Mat& image,
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
      pixel = kNoScoreColour;
      continue;
    }
    const double share = high > low ? std::clamp((scores[p] - low) / (high - low), 0.0, 1.0) : 0.5;
    const auto grey = static_cast<uint8_t>(255 * (is_distance ? share : 1 - share));
    pixel = cv::Vec3b(grey, grey, grey);
  }
  return is_distance ? std::pair(low, high) : std::pair(high, low);
}

// The columns [first, end) of one sequence whose anchors show the place of a row's.
std::vector<std::pair<size_t, size_t>> true_columns(const GroundTruth& truth,
                                                    const ScoreLayout& layout, size_t row,
                                                    const ScoreLayout::Columns& columns,
                                                    const Monitor& monitor) {
  check_stop(monitor);
  std::vector<std::pair<size_t, size_t>> found;
  const size_t first_anchor = layout.anchor(0);
  for (const LabelRun& run :
       label_runs(truth, layout.anchor(row), columns.sequence, layout.anchor(columns.count))) {
    if (run.label != PlaceLabel::same || run.last < first_anchor) continue;
    found.emplace_back(columns.first + std::max(run.first, first_anchor) - first_anchor,
                       columns.first + run.last - first_anchor + 1);
  }
  return found;
}

}  // namespace

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

ScorePicture draw_scores(const Judgement& judgement, const GroundTruth& truth,
                         const PixelGrid& grid, const std::vector<double>& scores,
                         const Monitor& monitor) {
  const ScoreLayout& layout = judgement.layout;
  cv::Mat image(static_cast<int>(grid.rows), static_cast<int>(grid.cols), CV_8UC3,
                cv::Scalar::all(255));
  const auto greys = draw_grey(image, scores, judgement.outcomes.kind == ScoreOrder::distance);
  std::set<Meaning> shown;
  const auto set = [&](size_t row, size_t column, Meaning meaning) {
    image.at<cv::Vec3b>(static_cast<int>(row / grid.cells), static_cast<int>(column / grid.cells)) =
        bgr_of(meaning);
    shown.insert(meaning);
  };
  for (size_t row = 0; row < row_count(layout); ++row)
    for (const ScoreLayout::Columns& columns : layout.columns)
      for (const auto& [first, end] : true_columns(truth, layout, row, columns, monitor))
        for (size_t column = first; column < end; column = (column / grid.cells + 1) * grid.cells)
          set(row, column, Meaning::truth);
  for (const ScoreLayout::Columns& columns : layout.columns)
    if (columns.first > 0)
      image.col(static_cast<int>(columns.first / grid.cells)).setTo(bgr_of(Meaning::divider));
  for (const RecognisedCell& cell : judgement.recognised) {
    check_stop(monitor);
    const FrameMatch match = match_of_column(layout, cell.column);
    set(cell.query_window, cell.column,
        meaning_of(truth.label(layout.anchor(cell.query_window), match.sequence, match.reference)));
  }
  ScorePicture picture{chart_image(image, grid.cells), {shown.begin(), shown.end()}};
  picture.image.greys = greys;
  return picture;
}

ScorePicture draw_scores(const Judgement& judgement, const GroundTruth& truth,
                         const ScoreMatrix* matrix, size_t most_pixels, const Monitor& monitor) {
  const PixelGrid grid(judgement.layout, most_pixels);
  const std::vector<double> scores =
      matrix == nullptr ? std::vector<double>{} : scores_of(*matrix, grid, monitor);
  return draw_scores(judgement, truth, grid, scores, monitor);
}

}  // namespace vpr
