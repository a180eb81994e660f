// What FAB-MAP takes from the scores of cells, by its definition.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "matching/fusion.h"
#include "recognition/row_scan.h"

namespace vpr {

/// The oracle's rows of all query frames that cells' windows hold, each computed once.
class PlainFusion {
 public:
  /// `basis` must outlive it; `words` are those of the query's frames, where something is fused.
  PlainFusion(const FusionBasis& basis, std::span<const Cell> cells, size_t window_length,
              std::span<const WordSet> words, const Monitor& monitor);

  /// z of training frame i of a sequence and query frame j, less what FAB-MAP takes from it, cut
  /// off as scores are; z itself where nothing is fused.
  double operator()(double z, size_t sequence, size_t i, size_t j) const;

 private:
  std::map<size_t, size_t> first_frame_;            ///< in rows, of each sequence that is matched
  std::map<size_t, std::vector<double>> by_frame_;  ///< of the query
};

}  // namespace vpr
