// Poses of frames: their formats, and the frames within some meters and degrees of each other.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "truth/formats.h"

namespace vpr {

/// Metres; the heading in degrees, or the orientation as a rotation matrix, row by row.
struct Pose {
  std::array<double, 3> position{};
  std::optional<double> heading_deg;
  std::optional<std::array<double, 9>> orientation;
};

/// Per frame; nothing where a frame's pose is not known.
using Poses = std::vector<std::optional<Pose>>;

/// How far the known poses reach along each coordinate, in metres; minus infinity where none is.
std::array<double, 3> extents_of(const Poses& poses);

/// Degrees between two orientations, 0 to 180: of headings the difference round the circle, of
/// rotation matrices the angle of the rotation from one to the other. Nothing unless both have the
/// same kind.
std::optional<double> angle_between(const Pose& a, const Pose& b);

/// Labels every pair of a query frame and a frame of `sequence`: `same` if the distance is at most
/// the argument's radius_m and, where angle_deg is given, the angle at most that, both bounds
/// included; `ignore` if a pose is unknown. `usual_radius_m`: what the format's own protocol
/// states, for arguments without radius_m. Warns where more than a tenth of all pairs of known
/// poses are the same. Throws Error(data) if the numbers of poses are not those of the frames,
/// Error(usage) for a radius or angle that is none, and where no radius is known. Returns the
/// protocol in words. References are sorted by one coordinate, so that only those near it are
/// compared. Query frames of `nowhere`, which is empty or has one entry each, are different from
/// all.
std::string match_poses(GroundTruthBuilder& builder, size_t sequence, const Poses& query,
                        const Poses& train, std::optional<double> usual_radius_m = std::nullopt,
                        const std::vector<bool>& nowhere = {});

/// All take the query's poses from the argument's path and the training sequence's from its
/// `reference`, either with a range of frames (PATH@FIRST:LAST[:STEP]) where the sequence had one;
/// exactly one searched sequence. Distances are those of match_poses(). Throw Error(data), naming
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
