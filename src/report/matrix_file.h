// A score matrix on disk, written piece by piece as rows arrive.
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/json_fwd.h"
#include "base/output.h"
#include "evaluation/score_matrix.h"
#include "matching/rows.h"
#include "recognition/result.h"

namespace vpr {

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

}  // namespace vpr
