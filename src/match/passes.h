// Places that the training sequences pass several times, found by the filter's own rule.
#pragma once

#include <span>
#include <vector>

#include "base/monitor.h"
#include "match/row_kernels.h"
#include "store/train_statistics.h"

namespace vpr {

/// The training sequences as queries of their own past, one after the other: keyframes at least 32
/// keyframes earlier, and all earlier sequences. A keyframe that the filter recognizes by
/// `least_margin`, in units of PathTrack, is another pass through its match; keyframes between two
/// such ones at most 32 apart are too if their matches fit. Earlier passes do not compete with each
/// other. Increasing by frame. None for more than 2^32 pairs of frames. `statistics`: of the
/// training frames, with components. Throws Error(interrupted) on a stop.
std::vector<RepeatedPlace> find_passes(std::span<const DescribedFrames> train,
                                       const TrainStatistics& statistics, uint32_t least_margin,
                                       const RowKernels& kernels, const Monitor& monitor);

}  // namespace vpr
