// One pass over a score matrix: every query's outcome, and the scores of all pairs of one place.
#pragma once

#include <vector>

#include "evaluation/outcomes.h"

namespace vpr {

/// What one pass over a score matrix finds.
struct MatrixScan {
  Outcomes outcomes;
  uint64_t same_pairs = 0;          ///< of readable queries, those without a score included
  uint64_t ignored_pairs = 0;       ///< of readable queries
  uint64_t same_without_score = 0;  ///< of same_pairs
  std::vector<uint64_t> same_keys;  ///< sorted, one a pair of the same place that has a score
  uint64_t best_key = kNoScore;     ///< of all pairs that are not ignored
  uint64_t worst_correct = 0;       ///< queries whose worst score, first of ties, is right
};

/// References labelled ignore are passed over, as if they were not there: best match and rank are
/// those among the others. Ties go to the first column. A query without any score is unreadable.
/// Throws as ScoreMatrix::for_each_row does.
MatrixScan scan_matrix(const ScoreMatrix& matrix, const GroundTruth& truth,
                       const ScoreLayout& layout, const Monitor& monitor);

}  // namespace vpr
