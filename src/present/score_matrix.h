// Matrices of scores: as pictures with axes that count frames, and as files that a query writes
// while its rows arrive.
#pragma once

#include <atomic>
#include <span>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "base/output.h"
#include "evaluate/judgment.h"
#include "match/rows.h"
#include "present/chart.h"

namespace vpr {

/// A stretch of the axis: frames first_frame .. first_frame + count - 1 of a sequence, the first at
/// the position `at`.
struct FrameBand {
  std::string name;
  uint32_t sequence = 0;
  size_t at = 0;
  size_t first_frame = 0;
  size_t count = 0;
};

/// All frames of the searched training sequences, one behind the other.
std::vector<FrameBand> frame_bands(const ScoreLayout& layout);

/// The columns of the layout's matrix: a window stands at its anchor, the frame it is judged at.
std::vector<FrameBand> column_bands(const ScoreLayout& layout);

/// The rows of the layout's matrix, as one band without a name.
std::vector<FrameBand> row_bands(const ScoreLayout& layout);

/// Frames of all bands.
size_t length_of(const std::vector<FrameBand>& bands);

/// Where a frame stands on the axis; it is in one of the bands, which are by sequence.
size_t position_of(const std::vector<FrameBand>& bands, const FrameMatch& match);

/// A mark on an axis of frames.
struct AxisTick {
  double position = 0;  ///< of the middle of the frame
  size_t frame = 0;
};

/// Ticks at round frames (1, 2 or 5 times a power of ten apart) and at the first of each band, at
/// most about `most`: of two that are near each other the one at a band's start stays.
std::vector<AxisTick> ticks_of(const std::vector<FrameBand>& bands, size_t most);

/// An axis that counts the frames of bands. `is_down`: it starts at the top.
ChartAxis frame_axis(const std::vector<FrameBand>& bands, const std::string& label, bool is_down);

/// Scores as a picture with its axes.
struct ScorePicture {
  ChartImage image;
  std::vector<Meaning> shown;  ///< colors that occur, for a legend
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
/// truth and recognized cells have the palette's colors; the latter cover the former.
ScorePicture draw_scores(const Judgment& judgment, const GroundTruth& truth, const PixelGrid& grid,
                         const std::vector<double>& scores, const Monitor& monitor);

/// The same of a matrix, read row by row; null: no scores.
ScorePicture draw_scores(const Judgment& judgment, const GroundTruth& truth,
                         const ScoreMatrix* matrix, size_t most_pixels, const Monitor& monitor);

/// The picture with axes that count frames, a legend and, of scores, the scale of its grays.
/// `reference_word`: what the columns are; `score_words`: what the grays are.
Chart matrix_chart(const ScoreLayout& layout, const ScorePicture& picture,
                   const std::string& reference_word, const std::string& score_words);

/// The matrix of a result, in the pixels that its rows gave. Without a ground truth, recognitions
/// are not judged.
Chart result_matrix_chart(const Result& result, const RowPixels& pixels, const GroundTruth* truth,
                          const Monitor& monitor);

/// Where the windows of each searched sequence stand, as a result file says it.
Json matrix_layout_json(const ScoreLayout& layout);

/// int32, query windows x train windows. Where a window has an unreadable frame there is what the
/// score has for a missing one. The file has its whole size from the start and is never in memory.
class MatrixFile {
 public:
  /// `has_gaps`: some window has an unreadable frame, so that not every cell will arrive.
  MatrixFile(Output& file, const Result& result, bool has_gaps, const Monitor& monitor);
  /// Takes part of a row, from any thread.
  void operator()(const ScoreRow& row);
  /// Its object in a result: rows and checksum. Reads the whole file.
  Json entry(const Monitor& monitor) const;

 private:
  Output& file_;
  ScoreLayout layout_;
  int64_t score_offset_;  // what is taken from the sums of rows
  size_t header_bytes_ = 0;
};

/// Posteriors of FAB-MAP (.npy, float64): one row per query frame, a column for the new place and
/// one per view. Takes the rows in the order of frames. A view that is not known yet (in loops) has
/// 0, an unreadable frame not a number.
class PosteriorFile {
 public:
  PosteriorFile(Output& file, size_t frames, size_t views);
  /// New place first; empty for an unreadable frame.
  void add(std::span<const double> posterior);
  /// What the result says of the file, when all rows are there.
  Json entry(const Monitor& monitor) const;

 private:
  Output& file_;
  size_t frames_;
  size_t columns_;
};

}  // namespace vpr
