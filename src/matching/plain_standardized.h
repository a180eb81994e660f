// Standardized scores as the method is stated, in double precision and without re-use: the oracle
// that fixed-point scores are compared with.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "matching/components.h"
#include "matching/standardization.h"

namespace vpr {

/// What the scores of a query need that does not depend on the training frame.
struct PlainUpdates {
  std::vector<double> row_means;      ///< per query frame: mean distance over the training frames
  std::vector<CommonWeights> common;  ///< per query frame
  /// Per query frame: the frame whose distances are learned before it is scored.
  std::vector<std::optional<size_t>> learned;
};

/// `centred_over`: all training frames that rows are centred over, with what can't be read.
PlainUpdates plain_updates(std::span<const DescriptorSpan> centred_over,
                           const DescriptorSpan& query, const ScoreBasis& basis,
                           const Monitor& monitor);

/// z of every query frame to one training frame, within [-32, 32). W, S1 and S2 are the weight, the
/// sum and the sum of squares: mean S1 / W, variance S2 / W - mean^2. `frame`: which of the
/// basis's training frames it is.
std::vector<double> plain_frame_scores(DescriptorRow train, size_t frame,
                                       const DescriptorRows& query, const PlainUpdates& updates,
                                       const ScoreBasis& basis);

/// The largest difference of a window's score in fixed point from that in double precision: half a
/// unit per frame is rounded away, and single-precision statistics may cost as much again.
double score_tolerance(size_t window_length);

}  // namespace vpr
