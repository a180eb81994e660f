// Poses of query and training frames, as text.
#pragma once

#include "ground_truth/formats.h"

namespace vpr {

/// All take the query's poses from the argument's path and the training sequence's from its
/// `reference`, either with a range of frames (PATH@FIRST:LAST[:STEP]) where the sequence had one;
/// exactly one searched sequence. Distances are those of pose_matches.h. Throw Error(data), naming
/// the line.

/// CSV with columns frame, x, y and maybe heading (others are not looked at): metres, and degrees.
/// Frames may be missing and in any order; pairs with a missing one are ignored.
std::string read_poses(GroundTruthBuilder& builder);
/// Whether the first line is a header that names frame, x and y.
bool is_pose_csv(const FileStart& start);

/// One pose a line, time x y z qx qy qz qw (the RGB-D benchmark of the TU Munich); lines that start
/// with # are skipped. Poses of frames are found by time where the argument has the frames' times
/// (association.h); otherwise line i is frame i, and times are not looked at.
std::string read_tum_poses(GroundTruthBuilder& builder);
/// Whether the first line holds eight numbers with spaces between them.
bool is_tum(const FileStart& start);

/// One pose a line, the 3 x 4 matrix (rotation, position) row by row (the KITTI odometry
/// benchmark), by time or line as of tum. A matrix whose first three columns are no rotation is
/// refused.
std::string read_kitti_poses(GroundTruthBuilder& builder);
/// One pose a line with its time, as EuRoC has it (trajectory.h), by time or line as of tum.
std::string read_euroc_poses(GroundTruthBuilder& builder);
/// Whether the first line holds twelve numbers with spaces between them.
bool is_kitti(const FileStart& start);

}  // namespace vpr
