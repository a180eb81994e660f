// Causal z-scores of a sequence against its own past: they use only frames already seen.
#pragma once

#include "match/frame_distances.h"
#include "match/zscore_model.h"

namespace vpr {

/// Throws Error(usage) for settings that need a complete training sequence: components of its
/// frames, unless they have the default value, which counts as 0 here.
void check_past_settings(const ZScoreSettings& settings);

/// The frame distances of a sequence to itself, whose `past` is set, as scores (score_kernels.h) in
/// order, which depend only on frames up to the query frame. With P(j) the readable frames of the
/// past of frame j, and h the distances of readable frames:
/// - rows: x(j, i) = h(j, i) - r(j), where r(j) is the mean of h(j, .) over P(j);
/// - columns start with the mean start_bias * (r(i) - R(i)), where R(i) is the mean of r up to
///   frame i, or 0 if frame i has no past; and with the variance V(j) of the row in whose past they
///   enter: the mean of x^2 over all pairs so far and start_weight values with the variance of
///   unknown frames. Earlier rows have their own V;
/// - keyframes are learned as in zscores(), with the typical distance R of the previous frame,
///   but each keyframe only by the columns in its past, each with an initial weight of start_weight
///   keyframes.
/// Memory: 16 bytes per frame plus its entry in the past. Distances of keyframes are computed
/// twice.
FrameDistances past_zscores(FrameDistances distances, const ZScoreSettings& settings);

}  // namespace vpr
