// Poses of frames: their formats, and pairs of frames within a radius and an angle.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "truth/formats.h"

namespace vpr {

/// In meters; either the heading in degrees, or the orientation as a rotation matrix, row by row.
struct Pose {
  std::array<double, 3> position{};
  std::optional<double> heading_deg;
  std::optional<std::array<double, 9>> orientation;
};

/// One entry per frame; nullopt if the pose is unknown.
using Poses = std::vector<std::optional<Pose>>;

/// The extent of the known poses along each coordinate in meters; minus infinity if all are
/// unknown.
std::array<double, 3> extents_of(const Poses& poses);

/// Degrees between two orientations, 0 to 180: the difference of headings, or the angle of the
/// rotation between two rotation matrices. Nullopt if the two poses have different kinds.
std::optional<double> angle_between(const Pose& a, const Pose& b);

/// Labels every pair of a query frame and a frame of `sequence`: `same` if the distance is at most
/// the argument's radius_m and, if angle_deg is set, the angle is at most angle_deg (both
/// inclusive); `ignore` if a pose is unknown. `usual_radius_m`: the radius in the format's own
/// protocol, if the argument has none. Warns if more than a tenth of all pairs of known poses are
/// the same. Throws Error(data) if the numbers of poses and frames differ, Error(usage) for an
/// invalid radius or angle, and if there is no radius. Returns the protocol as text. References are
/// sorted by one coordinate, so that only nearby ones are compared. Query frames in `nowhere`,
/// which is empty or has one entry per frame, are different from all references.
std::string match_poses(GroundTruthBuilder& builder, size_t sequence, const Poses& query,
                        const Poses& train, std::optional<double> usual_radius_m = std::nullopt,
                        const std::vector<bool>& nowhere = {});

/// Readers of poses. All take the query's poses from the argument's path and the training
/// sequence's from its `reference`, each with a range of frames (PATH@FIRST:LAST[:STEP]) if the
/// sequence had one; all require exactly one searched sequence and use match_poses(). Throw
/// Error(data), with the line.

/// CSV with columns frame, x, y and optionally heading, in meters and degrees; other columns are
/// ignored. Frames may be missing and in any order; pairs with a missing frame are ignored.
std::string read_poses(GroundTruthBuilder& builder);
/// Whether the first line is a header with frame, x and y.
bool is_pose_csv(const FileStart& start);

/// One pose per line, time x y z qx qy qz qw (the RGB-D benchmark of TU Munich); lines that start
/// with # are skipped. Poses are associated by time if the argument has the frames' times
/// (association.h); otherwise line i belongs to frame i, and times are ignored.
std::string read_tum_poses(GroundTruthBuilder& builder);
/// Whether the first line holds eight numbers separated by spaces.
bool is_tum(const FileStart& start);

/// One pose per line, the 3 x 4 matrix (rotation, position) row by row (the KITTI odometry
/// benchmark), by time or line as for tum. Refuses a matrix whose first three columns are not a
/// rotation.
std::string read_kitti_poses(GroundTruthBuilder& builder);
/// One pose per line with its time, in EuRoC's format (trajectory.h), by time or line as for tum.
std::string read_euroc_poses(GroundTruthBuilder& builder);
/// Whether the first line holds twelve numbers separated by spaces.
bool is_kitti(const FileStart& start);

}  // namespace vpr
