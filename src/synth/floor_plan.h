// A floor plan as a grid of open and solid cells, its walls, and ray casting.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/types.hpp>

#include "synth/world.h"

namespace vpr {

/// A point on the floor, or a vector, in meters.
using Point = cv::Point2d;

/// The distance in meters, rounded the same way on every machine: std::hypot differs between
/// processors in the last digit.
double distance(Point a, Point b);

/// A side of a cell or room, on the plan.
enum class Side { right, up, left, down };

/// A straight piece of wall from corner to corner; `start` is its left end, seen from the room.
struct Wall {
  Point start;
  Side side = Side::right;  ///< position relative to the room
  double length_m = 0;
  bool is_glass = false;
  bool is_pillar = false;

  /// Unit vector from the left end to the right end, seen from the room.
  Point direction() const;
  /// The point at this distance from the left end, and from the wall into the room.
  Point at(double along_m, double inward_m = 0) const;
};

struct Lamp {
  Point at;
  size_t room = 0;   ///< index in the floor's rooms
  double power = 1;  ///< factor of its brightness
};

/// A floor on a grid of kPlanCellM: the walkable cells and the walls around them.
struct FloorPlan {
  Point origin;  ///< lower left corner of the grid, outside all rooms
  int columns = 0;
  int rows = 0;
  std::vector<uint8_t> open;     ///< rows x columns: 0 solid, 1 corridor, 2 hall
  std::vector<int32_t> wall_of;  ///< rows x columns x 4 sides: index of the wall, or -1
  std::vector<Wall> walls;
  std::vector<Lamp> lamps;

  /// As `open`; 0 outside the grid.
  uint8_t open_at(Point point) const;
  bool is_open(Point point) const { return open_at(point) != 0; }
};

/// The plan of a floor. A hall takes precedence over a corridor that overlaps it; pillars take
/// precedence over both.
FloorPlan make_floor_plan(const Floor& floor);

struct WallHit {
  double distance = 0;  ///< in units of the direction's length
  int32_t wall = 0;
  double along_m = 0;  ///< from the wall's left end
};

/// The first wall in this direction (any length > 0) from an open point; nullopt if the point is
/// inside a wall.
std::optional<WallHit> cast_ray(const FloorPlan& plan, Point from, Point direction);

bool can_see(const FloorPlan& plan, Point from, Point to);

}  // namespace vpr
