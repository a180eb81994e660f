#include "report/score_picture.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/mat.hpp>

#include "base/statistics.h"
#include "ground_truth/label_runs.h"

namespace vpr {
namespace {

/// Cells to pixels.
struct Grid {
  size_t scale = 1;
  size_t rows = 1;
  size_t cols = 1;

  Grid(const ScoreLayout& layout, size_t most_pixels) {
    const size_t height = std::max<size_t>(1, row_count(layout));
    const size_t width = std::max<size_t>(1, column_count(layout));
    scale = (std::max(height, width) + most_pixels - 1) / most_pixels;
    rows = (height + scale - 1) / scale;
    cols = (width + scale - 1) / scale;
  }
  /// The first column of the pixel behind that of a column.
  size_t next_pixel(size_t column) const { return (column / scale + 1) * scale; }
  cv::Vec3b& pixel(cv::Mat& image, size_t row, size_t column) const {
    return image.at<cv::Vec3b>(static_cast<int>(row / scale), static_cast<int>(column / scale));
  }
};

/// Gives the scores of black and white.
std::optional<std::pair<double, double>> draw_grey(cv::Mat& image, const Grid& grid,
                                                   const ScoreMatrix& matrix,
                                                   const Monitor& monitor) {
  std::vector<uint64_t> best(grid.rows * grid.cols, kNoScore);
  matrix.for_each_row(1, monitor, "drawing scores",
                      [&](size_t, size_t row, std::span<const uint64_t> keys) {
                        uint64_t* line = &best[row / grid.scale * grid.cols];
                        for (size_t c = 0; c < keys.size(); ++c)
                          line[c / grid.scale] = std::min(line[c / grid.scale], keys[c]);
                      });
  std::vector<double> values;
  for (const uint64_t key : best) {
    const double value = score_of_key(key, matrix.kind());
    if (std::isfinite(value)) values.push_back(value);
  }
  if (values.empty()) return std::nullopt;
  const double low = quantile(values, 0.01);
  const double high = quantile(values, 0.99);
  const bool is_distance = matrix.kind() == ScoreOrder::distance;
  for (size_t p = 0; p < best.size(); ++p) {
    if (best[p] == kNoScore) continue;
    const double value = score_of_key(best[p], matrix.kind());
    const double share = high > low ? std::clamp((value - low) / (high - low), 0.0, 1.0) : 0.5;
    const auto grey = static_cast<uint8_t>(255 * (is_distance ? share : 1 - share));
    image.at<cv::Vec3b>(static_cast<int>(p / grid.cols), static_cast<int>(p % grid.cols)) =
        cv::Vec3b(grey, grey, grey);
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

ScorePicture draw_scores(const Judgement& judgement, const GroundTruth& truth,
                         const ScoreMatrix* matrix, size_t most_pixels, const Monitor& monitor) {
  const ScoreLayout& layout = judgement.layout;
  const Grid grid(layout, most_pixels);
  ScorePicture picture;
  picture.cells = grid.scale;
  picture.image.create(static_cast<int>(grid.rows), static_cast<int>(grid.cols), CV_8UC3);
  picture.image.setTo(cv::Scalar(255, 255, 255));
  if (matrix != nullptr) picture.greys = draw_grey(picture.image, grid, *matrix, monitor);
  std::vector<bool> is_shown(palette().size());
  const auto set = [&](size_t row, size_t column, Meaning meaning) {
    grid.pixel(picture.image, row, column) = bgr_of(meaning);
    is_shown[static_cast<size_t>(meaning)] = true;
  };
  for (size_t row = 0; row < row_count(layout); ++row)
    for (const ScoreLayout::Columns& columns : layout.columns)
      for (const auto& [first, end] : true_columns(truth, layout, row, columns, monitor))
        for (size_t column = first; column < end; column = grid.next_pixel(column))
          set(row, column, Meaning::truth);
  for (const ScoreLayout::Columns& columns : layout.columns)
    if (columns.first > 0)
      picture.image.col(static_cast<int>(columns.first / grid.scale))
          .setTo(bgr_of(Meaning::divider));
  for (const RecognisedCell& cell : judgement.recognised) {
    check_stop(monitor);
    const FrameMatch match = match_of_column(layout, cell.column);
    set(cell.query_window, cell.column,
        meaning_of(truth.label(layout.anchor(cell.query_window), match.sequence, match.reference)));
  }
  for (const PaletteColour& colour : palette())
    if (is_shown[static_cast<size_t>(colour.meaning)]) picture.shown.push_back(colour.meaning);
  return picture;
}

}  // namespace vpr
