// What the rows and columns of a score matrix are: windows (or frames) of which sequences.
#pragma once

#include <vector>

#include "evaluation/score_matrix.h"
#include "ground_truth/ground_truth.h"
#include "recognition/result.h"

namespace vpr {

/// A row is a window of the query, a column a window of a training sequence, both indexed by their
/// first frame and judged at their anchor, their last; frames are windows of length 1.
struct ScoreLayout {
  /// The windows of one searched training sequence, side by side.
  struct Columns {
    uint32_t sequence = 0;
    size_t first = 0;
    size_t count = 0;
  };
  GroundTruthScope scope;
  size_t window_length = 1;
  std::vector<Columns> columns;  ///< by sequence

  size_t anchor(size_t window) const { return window + window_length - 1; }
  /// Those of a sequence; none of one that was not searched, or has no window.
  const Columns* columns_of(uint32_t sequence) const;
};

/// A matrix with one training sequence, called "references". window_length is at least 1.
ScoreLayout layout_of(const ScoreMatrix& matrix, size_t window_length);

/// The matrix of a result, as vpr-query saves it.
ScoreLayout layout_of(const Result& result);

/// Rows and columns of the whole matrix.
size_t row_count(const ScoreLayout& layout);
/// Columns of the whole matrix: windows of all searched training sequences.
size_t column_count(const ScoreLayout& layout);

/// Checks that a matrix has as many rows and columns as a layout. Throws Error(data) if it has not.
void require_fit(const ScoreMatrix& matrix, const ScoreLayout& layout);

/// The labels of all columns for the query window `row`: `labels` is made that long.
void label_row(const GroundTruth& truth, const ScoreLayout& layout, size_t row,
               std::vector<PlaceLabel>& labels);

/// Whether a column can be right for a query anchor: the anchor of one shows the same place. False
/// for a place that the ground truth has only where no window of the layout ends.
bool has_column_of(const GroundTruth& truth, const ScoreLayout& layout, size_t anchor);

/// Sequence and anchor frame of a column, which exists.
struct FrameMatch {
  uint32_t sequence = 0;
  size_t reference = 0;

  bool operator==(const FrameMatch&) const = default;
};
/// The training sequence of a column, and the anchor of its window.
FrameMatch match_of_column(const ScoreLayout& layout, size_t column);

}  // namespace vpr
