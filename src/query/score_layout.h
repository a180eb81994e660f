// The windows of a query and of training sequences as rows and columns of a matrix of scores.
#pragma once

#include <cstdint>
#include <vector>

#include "query/result.h"
#include "truth/ground_truth.h"

namespace vpr {

/// The meaning of rows and columns: windows of the query and of training sequences, indexed by
/// their first frame and judged at their anchor. Frames are windows of length 1.
struct ScoreLayout {
  /// The windows of one searched training sequence.
  struct Columns {
    uint32_t sequence = 0;
    size_t first = 0;
    size_t count = 0;
  };
  GroundTruthScope scope;
  size_t window_length = 1;
  std::vector<Columns> columns;  ///< by sequence

  size_t anchor(size_t window) const { return window + window_length - 1; }
  /// Null for a sequence that was not searched or has no window.
  const Columns* columns_of(uint32_t sequence) const;
};

/// The matrix of a result, as vpr-query saves it.
ScoreLayout layout_of(const Result& result);

/// The sequences of a result. The places of FAB-MAP count as frames.
GroundTruthScope scope_of(const Result& result);

/// The number of windows of this length.
size_t window_count(size_t frames, size_t window_length);
size_t row_count(const ScoreLayout& layout);
size_t column_count(const ScoreLayout& layout);

/// A training sequence and the anchor of a window.
struct FrameMatch {
  uint32_t sequence = 0;
  size_t reference = 0;

  bool operator==(const FrameMatch&) const = default;
};
struct MatchedFrame {
  size_t query = 0;
  FrameMatch match;

  bool operator==(const MatchedFrame&) const = default;
};
/// The anchors of the windows of a match.
MatchedFrame anchors_of(const Match& match, size_t window_length);
/// `column` is below column_count.
FrameMatch match_of_column(const ScoreLayout& layout, size_t column);

}  // namespace vpr
