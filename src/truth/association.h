// Associates frames with poses by time, as evo does, and interpolates poses.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "base/monitor.h"
#include "truth/dataset.h"
#include "truth/trajectory.h"

namespace vpr {

/// The association of frames with poses.
struct AssociationRules {
  /// maximum distance of a frame to its nearest pose, inclusive; evo's default
  int64_t max_difference_ns = 20'000'000;
  int64_t offset_ns = 0;  ///< added to the times of frames
};

/// One entry per frame: the position on the straight line between the poses before and after its
/// time (before the first and after the last pose, the position of that pose), and heading and
/// orientation of the nearest pose, the earlier one on a tie. Nullopt if the nearest pose is
/// farther away than the maximum difference. Both times must increase; the trajectory must not be
/// empty. One pass over both.
Poses poses_at(const Trajectory& trajectory, std::span<const int64_t> frame_times,
               const AssociationRules& rules);

/// As poses_at, with checks: warns if more than half of the frames have no pose; throws Error(data)
/// with both ranges of times if none has. Both messages include the median difference between
/// frames and their nearest poses. `frames`: a description of the frames.
Poses associate(const Trajectory& trajectory, std::span<const int64_t> frame_times,
                const AssociationRules& rules, const std::string& frames, const Monitor& monitor);

/// A side of a ground truth.
enum class PoseSide { query, train };

/// evo's maximum distance between a frame and its nearest pose, in seconds.
inline constexpr double kEvoDifference = 0.02;

/// ", by time within 0.02 s" for a protocol; empty without times of frames. `usual_difference_s`:
/// the default of --max-difference.
std::string times_in_words(const GroundTruthOptions& options,
                           double usual_difference_s = kEvoDifference);

/// The poses of the frames of one side: by time if the options have the times of frames (as
/// associate() does; poses without a position are removed first); otherwise pose i belongs to frame
/// i. Throws as associate() and the readers of times do, and Error(usage) for options that lack a
/// required option or have invalid values.
Poses poses_of_side(const GroundTruthOptions& options, PoseSide side, Trajectory trajectory,
                    const Monitor& monitor, double usual_difference_s = kEvoDifference);

/// The poses of training frames.
struct TrainPoses {
  Poses poses;
  bool is_on_earth = false;  ///< positions are those of gps.h
};

/// The pose of each training frame, from `path` in any format of read_trajectory, by time if the
/// options have the times of frames. Throws as poses_of_side does.
TrainPoses read_train_poses(const std::filesystem::path& path, const GroundTruthOptions& options,
                            const Monitor& monitor);

}  // namespace vpr
