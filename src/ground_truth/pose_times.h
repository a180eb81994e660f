// The poses of both sides' frames by their times.
#pragma once

#include <filesystem>
#include <string>

#include "ground_truth/dataset.h"
#include "ground_truth/pose_matches.h"
#include "ground_truth/trajectory.h"

namespace vpr {

struct Monitor;

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
  bool is_on_earth = false;  ///< positions are those of geodesy.h
};

/// Where each training frame was taken, in any format that read_trajectory reads: of `path`, by
/// time where the options say when they were taken. Throws as poses_of_side does.
TrainPoses read_train_poses(const std::filesystem::path& path, const GroundTruthOptions& options,
                            const Monitor& monitor);

}  // namespace vpr
