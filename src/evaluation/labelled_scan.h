// What rows of scores say of a query whose places are known.
#pragma once

#include <optional>
#include <vector>

#include "ground_truth/ground_truth.h"
#include "recognition/margin_scan.h"

namespace vpr {

/// By how much the best match of a query window would be better than the runner-up if neither the
/// place of the window nor its surroundings were trained. Takes rows as MarginScan does. Windows
/// are judged at their anchors; the surroundings are at most the width of a sequence before or
/// after a frame labelled same or ignore.
class LabelledScan {
 public:
  /// `truth` must live as long as the scan.
  LabelledScan(const GroundTruth& truth, Elsewhere elsewhere, size_t window_length,
               size_t query_windows, const RowKernels& kernels);
  void operator()(const ScoreRow& row);
  /// Per query window; none without a runner-up.
  std::vector<std::optional<uint32_t>> result() const;

 private:
  const GroundTruth& truth_;
  std::vector<uint32_t> widths_;
  size_t window_length_;
  MarginScan untrained_;
};

}  // namespace vpr
