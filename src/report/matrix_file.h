// A distance matrix on disk, written piece by piece as rows arrive.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

#include "base/json_fwd.h"
#include "base/output_file.h"
#include "matching/rows.h"
#include "recognition/sequence_result.h"

namespace vpr {

/// What stands in a saved matrix where there is no distance, or no standardized score.
inline constexpr int32_t kNoDistance = -1;
inline constexpr int32_t kNoStandardizedScore = std::numeric_limits<int32_t>::min();

/// Columns of the whole matrix: all windows of the searched sequences, one after the other.
struct MatrixLayout {
  size_t rows = 0;  ///< query windows
  size_t cols = 0;
  std::vector<size_t> first_column;  ///< per sequence
  bool has_scores = false;           ///< standardized ones, and not distances
  int64_t score_offset = 0;          ///< what is taken from biased sums
};

MatrixLayout matrix_layout(const SequenceResult& result);

/// The layout as it stands in a result file.
Json matrix_layout_json(const MatrixLayout& layout, const SequenceResult& result);

/// int32, query windows x train windows. Where a window has an unreadable frame there is -1, or,
/// among scores, which may be negative, the smallest int32. The file has its whole size from the
/// start and is never in memory.
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
