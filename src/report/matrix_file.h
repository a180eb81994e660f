// A distance matrix on disk, written piece by piece as rows arrive.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/json_fwd.h"
#include "base/output_file.h"
#include "matching/rows.h"
#include "recognition/sequence_result.h"

namespace vpr {

/// Columns of the whole matrix: all windows of the searched sequences, one after the other.
struct MatrixLayout {
  size_t rows = 0;  ///< query windows
  size_t cols = 0;
  std::vector<size_t> first_column;  ///< per sequence
  int64_t score_offset = 0;          ///< what is taken from the sums of rows
  int32_t missing = -1;              ///< where there is no score
};

MatrixLayout matrix_layout(const SequenceResult& result);

/// The layout as it stands in a result file.
Json matrix_layout_json(const MatrixLayout& layout, const SequenceResult& result);

/// int32, query windows x train windows. Where a window has an unreadable frame there is what the
/// score has for a missing one. The file has its whole size from the start and is never in memory.
class MatrixFile {
 public:
  /// `has_gaps`: some window has an unreadable frame, so that not every cell will arrive.
  MatrixFile(OutputFile& file, const MatrixLayout& layout, bool has_gaps, const Monitor& monitor);
  /// Takes part of a row, from any thread.
  void operator()(const DistanceRow& row);
  /// Its object in a result: rows and checksum. Reads the whole file.
  Json entry(const Monitor& monitor) const;

 private:
  OutputFile& file_;
  MatrixLayout layout_;
  size_t header_bytes_ = 0;
};

}  // namespace vpr
