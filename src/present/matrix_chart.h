// Score matrices: axes that count frames, and charts.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "evaluate/judgment.h"
#include "match/match.h"
#include "present/chart.h"

namespace vpr {

/// A part of an axis: frames first .. first + count - 1 of a sequence, the first at position `at`.
struct FrameBand {
  std::string name;
  uint32_t sequence = 0;
  size_t at = 0;
  size_t first = 0;
  size_t count = 0;
};

VPR_FIELDS(FrameBand, (sequence), (at), (first), (count))

/// All frames of the searched training sequences, in their order.
std::vector<FrameBand> frame_bands(const ScoreLayout& layout);

/// The columns of the matrix. The position of a window is its anchor.
std::vector<FrameBand> column_bands(const ScoreLayout& layout);

/// The rows of the matrix, as one band without a name.
std::vector<FrameBand> row_bands(const ScoreLayout& layout);

size_t length_of(const std::vector<FrameBand>& bands);

/// The position of a frame, which must be in one of the bands; these are ordered by sequence.
size_t position_of(const std::vector<FrameBand>& bands, const FrameMatch& match);

/// Ticks in the middle of round frames (1, 2 or 5 times a power of ten apart) and of the first
/// frame of each band, at most about `most`. The first tick of a band replaces a close tick of the
/// previous band.
std::vector<ChartTick> ticks_of(const std::vector<FrameBand>& bands, size_t most);

/// An axis with these ticks. `is_down`: starts at the top. The label of frames has the name of a
/// single band.
ChartAxis frame_axis(const std::vector<FrameBand>& bands, const std::string& label, bool is_down);

/// The cells of a layout in an image of at most `most_pixels` x `most_pixels`, and at least one.
struct PixelGrid {
  size_t cells = 1;  ///< rows, and columns, per pixel
  size_t rows = 1;
  size_t cols = 1;

  PixelGrid(const ScoreLayout& layout, size_t most_pixels);
  size_t index(size_t row, size_t column) const { return row / cells * cols + column / cells; }
};

/// Collects the smallest distance, or biased sum, of each pixel from the rows of a matcher.
class RowPixels {
 public:
  RowPixels(const ScoreLayout& layout, size_t most_pixels);
  /// Accepts part of a row, on any thread.
  void operator()(const ScoreRow& row);
  const PixelGrid& grid() const { return grid_; }
  /// One per pixel, minus `offset`; NaN without a row.
  std::vector<double> scores(int64_t offset) const;

 private:
  ScoreLayout layout_;
  PixelGrid grid_;
  std::vector<std::atomic<uint32_t>> closest_;
};

/// The best score of each pixel; NaN without a score.
std::vector<double> pixel_scores(const ScoreMatrix& matrix, const PixelGrid& grid,
                                 const Monitor& monitor);

/// How people read a score: divided, with words for its unit.
struct ScoreUnit {
  std::string words;
  double divisor = 1;
};

/// Per frame of a window.
ScoreUnit score_unit(const QuerySettings& settings, size_t window_length);

/// Query windows from top to bottom, training windows (`reference`: "training frame") from left to
/// right, with a line between sequences. `scores`: as from pixel_scores; empty: white. The best
/// score is black; grays are linear up to white for the worst 1 %. Ground truth is an outline,
/// under boxes of recognized cells.
Chart matrix_chart(const Judgment& judgment, const GroundTruth& truth, const PixelGrid& grid,
                   const std::vector<double>& scores, const std::string& reference,
                   const ScoreUnit& unit, const Monitor& monitor);

/// The matrix of a result from its collected rows. Recognitions are not judged.
Chart result_matrix_chart(const Result& result, const RowPixels& pixels, const Monitor& monitor);

}  // namespace vpr
