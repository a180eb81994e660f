#include "synth/floor_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vpr {
namespace {

constexpr double kLampSpacingM = 3;
constexpr double kHallLampSpacingM = 4;

struct Step {
  int column;
  int row;
};

// By side: to the cell behind it, along its walls, and from the lower left corner of the cell to
// the left end of the side, seen from the cell.
constexpr std::array<Step, 4> kAcross = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
constexpr std::array<Step, 4> kAlong = {{{0, -1}, {1, 0}, {0, 1}, {-1, 0}}};
constexpr std::array<Step, 4> kStart = {{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};

int cell(double meters) { return static_cast<int>(std::lround(meters / kPlanCellM)); }

size_t cell_index(const FloorPlan& plan, int column, int row) {
  return static_cast<size_t>(row) * static_cast<size_t>(plan.columns) + static_cast<size_t>(column);
}

uint8_t open_at(const FloorPlan& plan, int column, int row) {
  const bool inside = column >= 0 && row >= 0 && column < plan.columns && row < plan.rows;
  return inside ? plan.open[cell_index(plan, column, row)] : 0;
}

// The walkable cells, in a border of solid cells, so that every ray ends.
void lay_grid(const Floor& floor, FloorPlan& plan) {
  const auto [left, bottom, right, top] = extent_of(floor);
  plan.origin = {left - kPlanCellM, bottom - kPlanCellM};
  plan.columns = cell(right - left) + 2;
  plan.rows = cell(top - bottom) + 2;
  plan.open.assign(static_cast<size_t>(plan.columns) * static_cast<size_t>(plan.rows), 0);
  for (const Room& room : floor.rooms)
    for (int row = 0; row < cell(room.depth); ++row)
      for (int column = 0; column < cell(room.width); ++column) {
        uint8_t& open = plan.open[cell_index(plan, cell(room.x - plan.origin.x) + column,
                                             cell(room.y - plan.origin.y) + row)];
        open = std::max<uint8_t>(open, room.kind == RoomKind::hall ? 2 : 1);
      }
  for (const Pillar& pillar : floor.pillars)
    plan.open[cell_index(plan, cell(pillar.x - plan.origin.x), cell(pillar.y - plan.origin.y))] = 0;
}

bool is_glass(const Floor& floor, Point p) {
  return std::ranges::any_of(floor.glass, [&](const GlassFront& line) {
    const Point from(line.from_x, line.from_y), way = Point(line.to_x, line.to_y) - from;
    const double square = way.dot(way);
    const double t = square == 0 ? 0 : std::clamp((p - from).dot(way) / square, 0.0, 1.0);
    return distance(p, from + t * way) < kPlanCellM / 2;
  });
}

// The piece of wall at a side of a cell, as a wall of its own; nullopt if there is none.
std::optional<Wall> find_face(const Floor& floor, const FloorPlan& plan, int column, int row,
                              Side side) {
  const Step& across = kAcross[static_cast<size_t>(side)];
  if (open_at(plan, column, row) == 0 ||
      open_at(plan, column + across.column, row + across.row) != 0)
    return std::nullopt;
  const Step& start = kStart[static_cast<size_t>(side)];
  Wall face{{plan.origin.x + column * kPlanCellM + start.column * kPlanCellM,
             plan.origin.y + row * kPlanCellM + start.row * kPlanCellM},
            side,
            kPlanCellM};
  face.is_glass = is_glass(floor, face.at(kPlanCellM / 2));
  return face;
}

// Follows the wall to the right from its first face.
void trace_wall(const Floor& floor, FloorPlan& plan, int column, int row, Wall wall) {
  const Step& along = kAlong[static_cast<size_t>(wall.side)];
  wall.length_m = 0;
  for (auto face = find_face(floor, plan, column, row, wall.side);
       face && face->is_glass == wall.is_glass;
       face = find_face(floor, plan, column, row, wall.side)) {
    plan.wall_of[cell_index(plan, column, row) * 4 + static_cast<size_t>(wall.side)] =
        static_cast<int32_t>(plan.walls.size());
    wall.length_m += kPlanCellM;
    column += along.column;
    row += along.row;
  }
  wall.is_pillar = wall.length_m <= kPlanCellM && !wall.is_glass;
  plan.walls.push_back(wall);
}

void trace_walls(const Floor& floor, FloorPlan& plan) {
  plan.wall_of.assign(plan.open.size() * 4, -1);
  for (const Side side : {Side::right, Side::up, Side::left, Side::down}) {
    const Step& along = kAlong[static_cast<size_t>(side)];
    for (int row = 0; row < plan.rows; ++row)
      for (int column = 0; column < plan.columns; ++column) {
        const auto face = find_face(floor, plan, column, row, side);
        if (!face) continue;
        const auto before = find_face(floor, plan, column - along.column, row - along.row, side);
        if (!before || before->is_glass != face->is_glass)
          trace_wall(floor, plan, column, row, *face);
      }
  }
}

void hang_lamps(const Floor& floor, FloorPlan& plan) {
  for (size_t index = 0; index < floor.rooms.size(); ++index) {
    const Room& room = floor.rooms[index];
    const bool hall = room.kind == RoomKind::hall;
    const double usual = hall ? kHallLampSpacingM : kLampSpacingM;
    const double spacing = room.lamp_spacing_m > 0 ? room.lamp_spacing_m : usual;
    const auto steps = [&](double length) {
      return hall || length > 4 ? std::max(1, static_cast<int>(length / spacing)) : 1;
    };
    const int across = steps(room.width), up = steps(room.depth);
    for (int i = 0; i < across; ++i)
      for (int j = 0; j < up; ++j)
        plan.lamps.push_back(
            {{room.x + room.width * (i + 0.5) / across, room.y + room.depth * (j + 0.5) / up},
             index});
  }
}

}  // namespace

double distance(Point a, Point b) {
  const Point way = b - a;
  return std::sqrt(way.dot(way));
}

Point Wall::direction() const {
  const Step& along = kAlong[static_cast<size_t>(side)];
  return {static_cast<double>(along.column), static_cast<double>(along.row)};
}

Point Wall::at(double along_m, double inward_m) const {
  const Point way = direction();
  return start + along_m * way + inward_m * Point(way.y, -way.x);
}

uint8_t FloorPlan::open_at(Point point) const {
  return vpr::open_at(*this, static_cast<int>(std::floor((point.x - origin.x) / kPlanCellM)),
                      static_cast<int>(std::floor((point.y - origin.y) / kPlanCellM)));
}

FloorPlan make_floor_plan(const Floor& floor) {
  FloorPlan plan;
  lay_grid(floor, plan);
  trace_walls(floor, plan);
  hang_lamps(floor, plan);
  return plan;
}

// Steps from cell to cell along the ray (Amanatides & Woo 1987).
std::optional<WallHit> cast_ray(const FloorPlan& plan, Point from, Point direction) {
  if (!plan.is_open(from)) return std::nullopt;
  const double x = (from.x - plan.origin.x) / kPlanCellM, y = (from.y - plan.origin.y) / kPlanCellM;
  int column = static_cast<int>(x), row = static_cast<int>(y);
  const double dx = direction.x / kPlanCellM, dy = direction.y / kPlanCellM;
  const double never = std::numeric_limits<double>::infinity();
  const double step_x = dx == 0 ? never : 1 / std::abs(dx);
  const double step_y = dy == 0 ? never : 1 / std::abs(dy);
  double next_x = dx == 0 ? never : (dx > 0 ? column + 1 - x : x - column) * step_x;
  double next_y = dy == 0 ? never : (dy > 0 ? row + 1 - y : y - row) * step_y;
  while (true) {
    const bool in_x = next_x < next_y;
    const Side side = in_x ? (dx > 0 ? Side::right : Side::left) : (dy > 0 ? Side::up : Side::down);
    const Step& step = kAcross[static_cast<size_t>(side)];
    const double distance = in_x ? next_x : next_y;
    if (open_at(plan, column + step.column, row + step.row) == 0) {
      const int32_t index =
          plan.wall_of[cell_index(plan, column, row) * 4 + static_cast<size_t>(side)];
      const Wall& wall = plan.walls[static_cast<size_t>(index)];
      const Point hit = from + distance * direction;
      return WallHit{distance, index, (hit - wall.start).dot(wall.direction())};
    }
    column += step.column;
    row += step.row;
    (in_x ? next_x : next_y) += in_x ? step_x : step_y;
  }
}

bool can_see(const FloorPlan& plan, Point from, Point to) {
  const Point way = to - from;
  if (way == Point()) return plan.is_open(from);
  const auto hit = cast_ray(plan, from, way);
  return hit && hit->distance >= 1;
}

}  // namespace vpr
