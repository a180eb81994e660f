// Labels of recordings of which only some training frames are kept.
#pragma once

#include "ground_truth/ground_truth.h"

namespace vpr {

/// Labels of the recordings' frames become those of the frames that `scope` keeps of them; of
/// sequences that keep all, they stay. The tolerance is applied, and 0 afterwards. A stretch of
/// frames at the query's place of which none is kept is that of the kept frame nearest to it, the
/// earlier of two, so that a query frame does not lose its place; of frames to ignore, those that
/// are kept are ignored.
void keep_frames(GroundTruth& truth, const GroundTruthScope& scope);

}  // namespace vpr
