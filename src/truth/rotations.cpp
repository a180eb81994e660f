#include "truth/rotations.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

namespace vpr {
namespace {

/// Tolerance for the products of a matrix's rows: files with three digits have errors of 0.002.
constexpr double kRotationError = 0.01;
constexpr double kLeastLength = 0.5;
constexpr double kGreatestLength = 3;

}  // namespace

double length_of(const std::array<double, 4>& q) {
  return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

bool is_length(double length) { return length >= kLeastLength && length <= kGreatestLength; }

std::array<double, 9> matrix_of(const std::array<double, 4>& q, double length) {
  const double x = q[0] / length;
  const double y = q[1] / length;
  const double z = q[2] / length;
  const double w = q[3] / length;
  return {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
          2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
          2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
}

std::array<double, 9> matrix_of(const std::array<double, 3>& turns) {
  const auto [roll, pitch, yaw] = turns;
  const cv::Matx33d about_x(1, 0, 0,                             //
                            0, std::cos(roll), -std::sin(roll),  //
                            0, std::sin(roll), std::cos(roll));
  const cv::Matx33d about_y(std::cos(pitch), 0, std::sin(pitch),  //
                            0, 1, 0,                              //
                            -std::sin(pitch), 0, std::cos(pitch));
  const cv::Matx33d about_z(std::cos(yaw), -std::sin(yaw), 0,  //
                            std::sin(yaw), std::cos(yaw), 0,   //
                            0, 0, 1);
  return std::to_array((about_z * about_y * about_x).val);
}

bool is_rotation(const std::array<double, 9>& m) {
  const cv::Matx33d rows(m.data());
  const cv::Matx33d error = rows * rows.t() - cv::Matx33d::eye();
  return cv::norm(error, cv::NORM_INF) <= kRotationError && cv::determinant(rows) > 0;
}

bool are_radians(std::span<const double> angles) {
  return std::ranges::all_of(angles,
                             [](double angle) { return std::abs(angle) <= 2 * std::numbers::pi; });
}

void invert(Pose& pose) {
  const cv::Matx33d rotation = cv::Matx33d(pose.orientation->data()).t();
  const cv::Vec3d center = -(rotation * cv::Vec3d(pose.position.data()));
  std::copy_n(rotation.val, 9, pose.orientation->begin());
  std::copy_n(center.val, 3, pose.position.begin());
}

}  // namespace vpr
