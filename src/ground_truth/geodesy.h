// Positions on the earth, in metres.
#pragma once

#include <array>

namespace vpr {

/// Degrees north and east, as GPS has them (WGS84).
struct Geographic {
  double latitude_deg = 0;   ///< -90 to 90
  double longitude_deg = 0;  ///< any; whole turns make no difference
};

/// Metres from the centre of the earth: towards 0 N 0 E, towards 0 N 90 E and towards the north
/// pole, of a point on the ellipsoid (WGS84), whose height is left out. The straight line
/// between two points is shorter than the way on the ground by 1 mm of 10 km, and by 1 m of 100 km,
/// everywhere on earth.
std::array<double, 3> earth_position(const Geographic& place);

/// A plane that touches the earth in its origin.
class LocalPlane {
 public:
  /// `origin` as earth_position() gives it.
  explicit LocalPlane(const std::array<double, 3>& origin);

  /// Metres east, north and up of the origin, of a position as earth_position() gives it. It is a
  /// turn and a shift, so that distances stay what they are; those along the plane alone are
  /// shortened by at most 1.3 parts in a million 10 km from the origin.
  std::array<double, 3> local(const std::array<double, 3>& earth) const;

 private:
  std::array<double, 3> origin_;
  std::array<double, 9> axes_;  ///< east, north and up, row by row
};

}  // namespace vpr
