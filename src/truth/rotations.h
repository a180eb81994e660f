// Rotations of poses, as files write them: quaternions and matrices, with their plausibility.
#pragma once

#include <array>
#include <span>

#include "truth/trajectory.h"

namespace vpr {

/// Lengths of quaternions, some of which are not normalized. If more than half of them differ from
/// 1 by more than this tolerance, they are other values.
inline constexpr double kLengthTolerance = 0.1;

/// The length of a quaternion x, y, z, w.
double length_of(const std::array<double, 4>& q);
/// Whether a quaternion may have this length.
bool is_length(double length);
/// A quaternion of this length as a matrix, row by row.
std::array<double, 9> matrix_of(const std::array<double, 4>& q, double length);

/// Roll, pitch and yaw in radians: turns about x, then y, then z of the world.
std::array<double, 9> matrix_of(const std::array<double, 3>& turns);

/// Whether the rows are orthonormal and right-handed, up to rounding.
bool is_rotation(const std::array<double, 9>& m);

/// Whether angles may be radians.
bool are_radians(std::span<const double> angles);

/// The pose of a camera whose pose maps the world to it. The orientation is known.
void invert(Pose& pose);

}  // namespace vpr
