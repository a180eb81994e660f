// Frames taken within some metres and degrees of each other.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace vpr {

class GroundTruthBuilder;

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

}  // namespace vpr
