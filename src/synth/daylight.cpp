#include "synth/daylight.h"

#include <cmath>

#include <fmt/format.h>

namespace vpr {
namespace {

constexpr double kReachM = 14;
constexpr double kInFrontM = 0.3;         // of the glass
constexpr double kShareOfWindows = 0.35;  // of a wall that has some

bool is_outer(const FloorPlan& plan, const Wall& wall) {
  const Point way = wall_direction(wall.side);
  const Point out{-way.y, way.x};
  Point p{wall.start.x + way.x * wall.length_m / 2, wall.start.y + way.y * wall.length_m / 2};
  for (double metres = 0.25; metres < 500; metres += kPlanCellM)
    if (plan.is_open({p.x + out.x * metres, p.y + out.y * metres})) return false;
  return true;
}

}  // namespace

bool has_windows(const World& world, const FloorNames& names, const FloorPlan& plan, size_t wall) {
  RandomEngine building = named_engine(world.seed, fmt::format("windows/{}/{}", names.plan, wall));
  return uniform_unit(building) < 0.4 && is_outer(plan, plan.walls[wall]);
}

std::vector<DaylightSource> daylight_sources(const World& world, const FloorNames& names,
                                             const FloorPlan& plan) {
  std::vector<DaylightSource> sources;
  if (world.variety.window_light == 0) return sources;
  for (size_t i = 0; i < plan.walls.size(); ++i) {
    const Wall& wall = plan.walls[i];
    if (!wall.is_glass && !has_windows(world, names, plan, i)) continue;
    const Point way = wall_direction(wall.side), inward{way.y, -way.x};
    const double share = wall.is_glass ? 1 : kShareOfWindows;
    const int pieces = std::max(1, static_cast<int>(wall.length_m));
    for (int piece = 0; piece < pieces; ++piece) {
      const double along = (piece + 0.5) * wall.length_m / pieces;
      sources.push_back({{wall.start.x + way.x * along + inward.x * kInFrontM,
                          wall.start.y + way.y * along + inward.y * kInFrontM},
                         inward,
                         world.variety.window_light * share * wall.length_m / pieces});
    }
  }
  return sources;
}

double daylight_at(const FloorPlan& plan, const std::vector<DaylightSource>& sources, Point point) {
  double light = 0;
  for (const DaylightSource& source : sources) {
    const double dx = point.x - source.at.x, dy = point.y - source.at.y;
    const double square = dx * dx + dy * dy;
    if (square > kReachM * kReachM) continue;
    const double towards = (dx * source.inward.x + dy * source.inward.y + kInFrontM) /
                           std::sqrt(square + kInFrontM * kInFrontM);
    if (towards > 0 && can_see(plan, point, source.at))
      light += source.strength * std::min(1.0, towards) / (1 + square);
  }
  return light;
}

}  // namespace vpr
