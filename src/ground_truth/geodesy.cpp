#include "ground_truth/geodesy.h"

#include <cmath>
#include <numbers>

namespace vpr {
namespace {

/// WGS84: half the equator's diameter in metres, and how much less it is to the poles.
constexpr double kSemiMajorAxis = 6378137;
constexpr double kFlattening = 1 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2 - kFlattening);

}  // namespace

std::array<double, 3> earth_position(const Geographic& place) {
  const double latitude = place.latitude_deg * std::numbers::pi / 180;
  const double longitude = std::remainder(place.longitude_deg, 360.0) * std::numbers::pi / 180;
  const double sine = std::sin(latitude);
  // From the axis of the earth to the point, along its plumb line.
  const double normal = kSemiMajorAxis / std::sqrt(1 - kEccentricity2 * sine * sine);
  const double from_axis = normal * std::cos(latitude);
  return {from_axis * std::cos(longitude), from_axis * std::sin(longitude),
          normal * (1 - kEccentricity2) * sine};
}

LocalPlane::LocalPlane(const std::array<double, 3>& origin) : origin_(origin) {
  const double from_axis = std::sqrt(origin[0] * origin[0] + origin[1] * origin[1]);
  // East of a pole is where it is of the points 0 E beside it.
  const double cosine = from_axis > 0 ? origin[0] / from_axis : 1;
  const double sine = from_axis > 0 ? origin[1] / from_axis : 0;
  // The plumb line stands on the ellipsoid.
  const double rise = origin[2] / (1 - kEccentricity2);
  const double length = std::sqrt(from_axis * from_axis + rise * rise);
  const double level = from_axis / length;
  const double steep = rise / length;
  axes_ = {-sine,          cosine,       0,    -steep * cosine, -steep * sine, level,
           level * cosine, level * sine, steep};
}

std::array<double, 3> LocalPlane::local(const std::array<double, 3>& earth) const {
  std::array<double, 3> position{};
  for (size_t row = 0; row < 3; ++row)
    for (size_t k = 0; k < 3; ++k) position[row] += axes_[3 * row + k] * (earth[k] - origin_[k]);
  return position;
}

}  // namespace vpr
