// Poses at the times of frames, as evo associates them, and between poses.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "base/monitor.h"
#include "truth/dataset.h"
#include "truth/trajectory.h"

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

/// A side of a ground truth.
enum class PoseSide { query, train };

/// Seconds from a frame to its nearest pose at most, as evo has it.
inline constexpr double kEvoDifference = 0.02;

/// ", by time within 0.02 s" for a protocol; empty where no times of frames are given.
/// `usual_difference_s`: what counts without --max-difference.
std::string times_in_words(const GroundTruthOptions& options,
                           double usual_difference_s = kEvoDifference);

/// The poses of the frames of one side: by their times, where the options say when they were taken
/// (then every frame gets one of those that are known or none, as associate() does), and otherwise
/// pose i is that of frame i. Throws as associate() and the readers of times do, and Error(usage)
/// for options that lack what they belong to, or are no times.
Poses poses_of_side(const GroundTruthOptions& options, PoseSide side, Trajectory trajectory,
                    const Monitor& monitor, double usual_difference_s = kEvoDifference);

/// Where training frames were taken.
struct TrainPoses {
  Poses poses;
  bool is_on_earth = false;  ///< positions are those of gps.h
};

/// Where each training frame was taken, in any format that read_trajectory reads: of `path`, by
/// time where the options say when they were taken. Throws as poses_of_side does.
TrainPoses read_train_poses(const std::filesystem::path& path, const GroundTruthOptions& options,
                            const Monitor& monitor);

}  // namespace vpr
