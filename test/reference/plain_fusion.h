// Scores fused with FAB-MAP by their definition: the reference of match/fusion.h.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "decide/row_scan.h"
#include "match/fusion.h"
#include "match/standardization.h"

namespace vpr {

/// How far the reference may be from a fused score by the same weight, in 1/1024 deviation.
double fusion_tolerance(const FusionBasis& basis);

/// fusion_row in double precision, from the likelihoods of the definition (fabmap1).
FusionRow plain_fusion_row(const FusionBasis& basis, const WordSet& words, double weight);

/// The oracle's rows of all query frames that cells' windows hold, each computed once. Their
/// weights, which depend on all frames before, are those of scores in whole numbers, so that what
/// nearly ties is decided in the same way.
class PlainFusion {
 public:
  /// `basis` is of all training sequences, but its fusion of those that are searched. Nothing where
  /// nothing is fused.
  PlainFusion(std::span<const DescriptorSpan> train, const DescriptorSpan& query,
              const ScoreBasis& basis, std::span<const Cell> cells, size_t window_length,
              const Monitor& monitor);

  /// z of training frame i of a sequence and query frame j with what FAB-MAP adds, cut off as
  /// scores are; z itself where nothing is fused.
  double operator()(double z, size_t sequence, size_t i, size_t j) const;

 private:
  std::map<size_t, size_t> first_frame_;  ///< in rows, of each sequence that is matched
  std::map<size_t, FusionRow> by_frame_;  ///< of the query
};

}  // namespace vpr
