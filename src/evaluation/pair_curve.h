// The precision-recall curve over all pairs of a score matrix, exact, without sorting the matrix.
#pragma once

#include "evaluation/matrix_scan.h"

namespace vpr {

/// Every pair of a readable query that has a score and is not labelled ignore: accepted at a
/// threshold or not, correct if it is the same place. Recall is over all pairs of the same place,
/// those without a score included. `scan` is of the same matrix, truth and layout; its
/// same_keys are used up.
///
/// Only the scores of pairs of the same place are kept and sorted (8 bytes each, and some 60 for
/// each that differs); every other pair is counted between them, in one pass. Throws as
/// ScoreMatrix::for_each_row does.
Curve pair_curve(const ScoreMatrix& matrix, const GroundTruth& truth, const ScoreLayout& layout,
                 MatrixScan& scan, const Monitor& monitor);

}  // namespace vpr
