// Poses at the times of frames, as evo associates them, and between poses.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/monitor.h"
#include "ground_truth/trajectory.h"

namespace vpr {

/// How frames find their poses.
struct AssociationRules {
  int64_t max_difference_ns = 20'000'000;  ///< evo's; from a frame to its nearest pose, included
  int64_t offset_ns = 0;                   ///< what is added to the times of frames
};

/// One entry a frame: the position on the straight line between the poses before and after its
/// time, in front of the first and behind the last pose theirs, and heading and orientation of the
/// nearest pose (of two as near the earlier). Nothing where the nearest pose is farther away than
/// the maximal difference. Both times rise; the trajectory has some. One pass over both.
Poses poses_at(const Trajectory& trajectory, std::span<const int64_t> frame_times,
               const AssociationRules& rules);

/// The same, and what is odd: warns, with the median of the differences from frames to their
/// nearest poses, where more than half of the frames get no pose; throws Error(data), naming both
/// ranges of times, where none does. `frames`: what the times are of, in words.
Poses associate(const Trajectory& trajectory, std::span<const int64_t> frame_times,
                const AssociationRules& rules, const std::string& frames, const Monitor& monitor);

}  // namespace vpr
