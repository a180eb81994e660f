// A floor plan as a grid of open and solid cells, its walls, and rays that hit them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "synth/world.h"

namespace vpr {

/// A point on the floor, in metres.
struct Point {
  double x = 0;
  double y = 0;
};

/// Metres from one point to another, as every machine rounds them: std::hypot differs between
/// processors in the last digit.
double distance(Point a, Point b);

/// A side of a cell or room, on the plan.
enum class Side { right, up, left, down };

/// A straight piece of wall, from corner to corner, as seen from the room: `start` is its left end.
struct Wall {
  Point start;
  Side side = Side::right;  ///< where it lies, seen from the room
  double length_m = 0;
  bool is_glass = false;
  bool is_pillar = false;
};

/// Which way `along` grows on a wall that lies at `side`: to the right of who looks at it.
Point wall_direction(Side side);

/// A lamp on the ceiling.
struct Lamp {
  Point at;
  size_t room = 0;   ///< of the floor
  double power = 1;  ///< factor of its brightness
};

/// A floor on a grid of kPlanCellM: where one can walk, and the walls around it.
struct FloorPlan {
  Point origin;  ///< lower left corner of the grid, outside all rooms
  int columns = 0;
  int rows = 0;
  std::vector<uint8_t> open;     ///< rows x columns: 0 solid, 1 corridor, 2 hall
  std::vector<int32_t> wall_of;  ///< rows x columns x 4 sides: the wall there, or -1
  std::vector<Wall> walls;
  std::vector<Lamp> lamps;

  bool is_open(Point point) const;
};

/// The plan of a floor. Where a corridor and a hall overlap, there is a hall; pillars stand in
/// both.
FloorPlan make_floor_plan(const Floor& floor);

/// Where a ray meets a wall.
struct WallHit {
  double distance = 0;  ///< in lengths of the ray's direction
  int32_t wall = 0;
  double along_m = 0;  ///< from the wall's left end
};

/// The first wall in the direction (any length > 0) from an open point. Nothing if the point is in
/// a wall.
std::optional<WallHit> cast_ray(const FloorPlan& plan, Point from, Point direction);

/// Whether no wall stands between two points.
bool can_see(const FloorPlan& plan, Point from, Point to);

}  // namespace vpr
