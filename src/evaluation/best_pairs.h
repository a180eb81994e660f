// The best references of each query, as lists of pairs for other programs.
#pragma once

#include "evaluation/score_layout.h"

namespace vpr {

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
