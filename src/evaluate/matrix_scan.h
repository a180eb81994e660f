// All pairs of a score matrix judged by the ground truth.
#pragma once

#include "evaluate/metrics.h"
#include "evaluate/outcomes.h"
#include "evaluate/score_matrix.h"
#include "truth/ground_truth.h"

namespace vpr {

/// All pairs of readable queries, except pairs labeled ignore.
struct PairJudgment {
  Curve curve;                      ///< recall is over all pairs of the same place
  uint64_t ignored = 0;             ///< pairs labeled ignore
  uint64_t same_without_score = 0;  ///< included in curve.positives, but never found
  uint64_t worst_correct = 0;       ///< queries whose worst score, ties to the first, is correct
};

struct MatrixScan {
  Outcomes outcomes;
  PairJudgment pairs;
};

/// Best matches and ranks skip references labeled ignore; ties go to the first column. Reads the
/// matrix twice: memory is 8 bytes per pair of the same place, and about 60 per distinct score
/// among them, since all other pairs are only counted between these. Throws as
/// ScoreMatrix::for_each_row does.
MatrixScan scan_matrix(const ScoreMatrix& matrix, const GroundTruth& truth,
                       const ScoreLayout& layout, const Monitor& monitor);

}  // namespace vpr
