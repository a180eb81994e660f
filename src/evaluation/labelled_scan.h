// What rows of scores say of a query whose places are known.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ground_truth/ground_truth.h"
#include "recognition/margin_scan.h"

namespace vpr {

/// Of one query window; values are sums over the window, the better the smaller.
struct LabelledWindow {
  std::optional<uint32_t> right;  ///< the smallest of a pair labelled same
  std::optional<uint32_t> wrong;  ///< the smallest of a pair labelled different
  /// By how much the best match would be better than the best one elsewhere, were neither the
  /// place of the window nor what is beside it trained; none where nothing else is elsewhere.
  std::optional<uint32_t> untrained_margin;
};

/// Takes rows as MarginScan does. Windows are judged at their anchors; beside a place is what is at
/// most the width of its sequence before or behind a frame labelled same or ignore.
class LabelledScan {
 public:
  /// `truth` must live as long as the scan. `needs_support`: margins without the place are those of
  /// supported_margins.
  LabelledScan(const GroundTruth& truth, Elsewhere elsewhere, size_t window_length,
               size_t query_windows, const RowKernels& kernels, bool needs_support = false);
  ~LabelledScan();
  void operator()(const ScoreRow& row);
  std::vector<LabelledWindow> result() const;

 private:
  struct Windows;
  const GroundTruth& truth_;
  std::vector<uint32_t> widths_;
  size_t window_length_;
  MarginScan untrained_;
  bool needs_support_;
  std::unique_ptr<Windows> windows_;
};

}  // namespace vpr
