// One pass over a score matrix: every query's outcome, and the scores of all pairs of one place.
#pragma once

#include <optional>
#include <vector>

#include "decide/margin_scan.h"
#include "evaluate/outcomes.h"
#include "evaluate/score_matrix.h"
#include "truth/ground_truth.h"

namespace vpr {

/// What one pass over a score matrix finds.
struct MatrixScan {
  Outcomes outcomes;
  uint64_t same_pairs = 0;          ///< of readable queries, those without a score included
  uint64_t ignored_pairs = 0;       ///< of readable queries
  uint64_t same_without_score = 0;  ///< of same_pairs
  std::vector<uint64_t> same_keys;  ///< sorted, one a pair of the same place that has a score
  uint64_t worst_correct = 0;       ///< queries whose worst score, first of ties, is right
};

/// References labeled ignore are passed over, as if they were not there: best match and rank are
/// those among the others. Ties go to the first column. A query without any score is unreadable.
/// Throws as ScoreMatrix::for_each_row does.
MatrixScan scan_matrix(const ScoreMatrix& matrix, const GroundTruth& truth,
                       const ScoreLayout& layout, const Monitor& monitor);

/// Every pair of a readable query that has a score and is not labeled ignore: accepted at a
/// threshold or not, correct if it is the same place. Recall is over all pairs of the same place,
/// those without a score included. `scan` is of the same matrix, truth and layout; its
/// same_keys are used up.
///
/// Only the scores of pairs of the same place are kept and sorted (8 bytes each, and some 60 for
/// each that differs); every other pair is counted between them, in one pass. Throws as
/// ScoreMatrix::for_each_row does.
Curve pair_curve(const ScoreMatrix& matrix, const GroundTruth& truth, const ScoreLayout& layout,
                 MatrixScan& scan, const Monitor& monitor);

/// By how much the best match of a query window would be better than the runner-up if neither the
/// place of the window nor its surroundings were trained. Takes rows as MarginScan does. Windows
/// are judged at their anchors; the surroundings are at most the width of a sequence before or
/// after a frame labeled same or ignore.
class LabeledScan {
 public:
  /// `truth` must live as long as the scan.
  LabeledScan(const GroundTruth& truth, Elsewhere elsewhere, size_t window_length,
              size_t query_windows, const RowKernels& kernels);
  void operator()(std::span<const ScoreRow> row);
  /// Per query window; none without a runner-up.
  std::vector<std::optional<uint32_t>> result() const;

 private:
  const GroundTruth& truth_;
  std::vector<uint32_t> widths_;
  size_t window_length_;
  MarginScan untrained_;
};

/// A reference that a query was taken for: anchors, frames of the query and of a training sequence.
struct BestPair {
  size_t query = 0;
  FrameMatch match;

  bool operator==(const BestPair&) const = default;
};

/// The `most` best references of every query, the best first, ties to the first column; fewer where
/// fewer have a score. By query. Throws as ScoreMatrix::for_each_row does.
std::vector<BestPair> best_pairs(const ScoreMatrix& matrix, const ScoreLayout& layout, size_t most,
                                 const Monitor& monitor);

/// Of a result alone, its best matches.
std::vector<BestPair> best_pairs(const Result& result);

}  // namespace vpr
