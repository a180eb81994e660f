// A query x reference matrix of scores, in a .npy file of any program or computed row by row; never
// whole in memory.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "decide/result.h"
#include "decide/score_kind.h"
#include "match/given_distances.h"
#include "truth/ground_truth.h"

namespace vpr {

/// Scores that are read or computed when they are asked for.
struct ComputedScores {
  size_t queries = 0;
  size_t references = 0;
  size_t block = 1;  ///< queries that are computed together, at most
  ScoreOrder kind = ScoreOrder::distance;
  /// Writes the scores of queries [first, first + count) to all references, row by row; NaN where
  /// there is none. May be called from several threads at once.
  std::function<void(size_t first, size_t count, std::span<double> scores)> compute;
  std::function<std::string(const Monitor& monitor)> fingerprint;  ///< of what they are made of
};

/// A file of scores, or computed ones. NaN is not a score.
class ScoreMatrix {
 public:
  /// Throws as ScoreFile does.
  ScoreMatrix(const std::filesystem::path& path, const ScoreFormat& format);

  explicit ScoreMatrix(ComputedScores scores) : scores_(std::move(scores)) {}

  size_t queries() const { return scores_.queries; }
  size_t references() const { return scores_.references; }
  ScoreOrder kind() const { return scores_.kind; }

  /// Keys (score_key) of all references of one query; they live while the call lasts.
  using RowBody = std::function<void(size_t worker, size_t query, std::span<const uint64_t> keys)>;
  /// Calls body once for every query, in any order. `workers` (at least 1) calls may run at once,
  /// each with its own number below `workers`. Throws Error(data) for 64-bit integers beyond 2^53,
  /// which would not be told apart.
  void for_each_row(size_t workers, const Monitor& monitor, const std::string& step,
                    const RowBody& body) const;

  /// Of the whole file, or of what scores are computed of, as provenance has it.
  std::string fingerprint(const Monitor& monitor) const { return scores_.fingerprint(monitor); }

 private:
  ComputedScores scores_;
};

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
