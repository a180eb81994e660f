// The reference implementation of match/fusion.h: scores fused with FAB-MAP.
#pragma once

#include <map>
#include <span>

#include "base/monitor.h"
#include "decide/row_scan.h"
#include "match/fusion.h"
#include "match/zscores.h"

namespace vpr {

/// The maximum difference between the reference and a fused score with equal weight, in 1/1024
/// deviation.
double fusion_tolerance(const FusionBasis& basis);

/// fusion_row in double precision, from the likelihoods of the reference implementation (fabmap1).
FusionRow reference_fusion_row(const FusionBasis& basis, const WordSet& words, double weight);

/// The reference's rows of all query frames within the windows of cells, each computed once. Their
/// weights, which depend on all earlier frames, are computed from integer scores, so that near ties
/// are decided in the same way.
class ReferenceFusion {
 public:
  /// Does nothing without fusion.
  ReferenceFusion(std::span<const DescribedFrames> train, const DescribedFrames& query,
                  const ScoreBasis& basis, std::span<const Cell> cells, size_t window_length,
                  const Monitor& monitor);

  /// z of training frame i of a sequence and query frame j with FAB-MAP's term, clamped like
  /// scores; z itself without fusion.
  double operator()(double z, size_t sequence, size_t i, size_t j) const;

 private:
  std::map<size_t, size_t> first_frame_;  ///< in rows, for each matched sequence
  std::map<size_t, FusionRow> by_frame_;  ///< of the query
};

}  // namespace vpr
