// Standardized scores of a walk against its own past: nothing is learned that is not known yet.
#pragma once

#include "match/frame_distances.h"
#include "match/standardization.h"

namespace vpr {

/// Throws Error(usage) for settings that need what is only known of a whole training walk:
/// components of its frames, unless they are the default, which counts as 0 here.
void check_past_settings(const StandardizationSettings& settings);

/// The frame distances of a walk to itself, whose `past` is set, as scores (score_kernels.h), which
/// come in order and are those of frames up to the query frame alone. With P(j) the readable frames
/// of the past of frame j, and h the distances of readable frames:
/// - rows: x(j, i) = h(j, i) - r(j), r(j) the mean of h(j, .) over P(j);
/// - columns start with the mean start_bias * (r(i) - R(i)), R(i) the mean of r up to frame i, or 0
///   where frame i had no past; and with the variance V(j) of the row in whose past they enter: the
///   mean of x^2 over all pairs up to then, and start_weight ones that spread as unknown frames do.
///   Rows before have their own V;
/// - views are learned as in standardized(), with the typical distance R of the frame before, but a
///   view only by the columns that were its past, each from a weight of start_weight views on.
/// Memory: 16 bytes a frame beside its place in the past. Distances of views are computed twice.
FrameDistances standardized_past(FrameDistances distances, const StandardizationSettings& settings);

}  // namespace vpr
