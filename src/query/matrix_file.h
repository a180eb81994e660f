// Matrices of scores and posteriors, which a query writes row by row with its result.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "base/output.h"
#include "match/match.h"
#include "query/result_arrays.h"
#include "query/score_layout.h"

namespace vpr {

/// The first column of a searched sequence.
struct MatrixColumns {
  std::string sequence;
  size_t first_column = 0;
};

VPR_FIELDS(MatrixColumns, (sequence, "Name of the training sequence."), (first_column, "From 0."))

/// "matrix" of a result.
struct MatrixLayout {
  size_t rows = 0;
  size_t columns = 0;
  std::vector<MatrixColumns> sequences;
};

VPR_FIELDS(MatrixLayout, (rows, "Query windows."), (columns, "Training windows."),
           (sequences, "Which column starts which sequence."))

MatrixLayout matrix_layout(const ScoreLayout& layout);

/// An int32 file of query windows x training windows, which is never in memory as a whole. Windows
/// with an unreadable frame have the score's `missing` value.
class MatrixFile {
 public:
  /// `has_gaps`: some window has an unreadable frame, so that not every cell will arrive.
  MatrixFile(Output& file, const Result& result, bool has_gaps, const Monitor& monitor);
  /// Accepts part of a row, on any thread.
  void operator()(const ScoreRow& row);
  /// The file's entry in a result. Reads the whole file.
  FileEntry entry(const Monitor& monitor) const;

 private:
  Output& file_;
  ScoreLayout layout_;
  int64_t score_offset_;  // subtracted from the sums of rows
  size_t header_bytes_ = 0;
};

/// FAB-MAP's posteriors (.npy, float64): a row per query frame, a column for the new place and one
/// per view. Views that do not exist yet (in loops) have 0, unreadable frames NaN.
class PosteriorFile {
 public:
  PosteriorFile(Output& file, size_t frames, size_t views);
  /// Accepts the frames in order, new place first; empty for an unreadable frame.
  void add(std::span<const double> posterior);
  /// The file's entry in a result, after the last row.
  FileEntry entry(const Monitor& monitor) const;

 private:
  Output& file_;
  size_t frames_;
  size_t columns_;
};

}  // namespace vpr
