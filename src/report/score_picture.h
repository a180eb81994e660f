// Scores, ground truth and recognitions as the pixels of one picture.
#pragma once

#include <atomic>
#include <vector>

#include "base/monitor.h"
#include "evaluation/judgement.h"
#include "matching/rows.h"
#include "report/chart.h"

namespace vpr {

/// Scores as a picture with its axes.
struct ScorePicture {
  ChartImage image;
  std::vector<Meaning> shown;  ///< colours that occur, for a legend
};

/// The cells of a layout as the pixels of a picture of at most `most_pixels` a side, at least one.
struct PixelGrid {
  size_t cells = 1;  ///< rows, and columns, in a pixel
  size_t rows = 1;
  size_t cols = 1;

  PixelGrid(const ScoreLayout& layout, size_t most_pixels);
  size_t index(size_t row, size_t column) const { return row / cells * cols + column / cells; }
};

/// The smallest of the distances, or biased sums, that fall into each pixel, as a matcher's rows
/// bring them.
class RowPixels {
 public:
  RowPixels(const ScoreLayout& layout, size_t most_pixels);
  /// Takes part of a row, from any thread.
  void operator()(const ScoreRow& row);
  const PixelGrid& grid() const { return grid_; }
  /// By pixel, less `offset`; NaN where no row came.
  std::vector<double> scores(int64_t offset) const;

 private:
  ScoreLayout layout_;
  PixelGrid grid_;
  std::vector<std::atomic<uint32_t>> closest_;
};

/// Query windows from top to bottom, columns of the layout from left to right, sequences divided by
/// lines. `scores`: the best in each pixel, NaN for none; no scores at all give white. Dark is a
/// good score; the outer 1 % on both sides are cut off; a pixel without a score is bluish. Ground
/// truth and recognised cells have the palette's colours; the latter cover the former.
ScorePicture draw_scores(const Judgement& judgement, const GroundTruth& truth,
                         const PixelGrid& grid, const std::vector<double>& scores,
                         const Monitor& monitor);

/// The same of a matrix, read row by row; null: no scores.
ScorePicture draw_scores(const Judgement& judgement, const GroundTruth& truth,
                         const ScoreMatrix* matrix, size_t most_pixels, const Monitor& monitor);

}  // namespace vpr
