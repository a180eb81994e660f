// The appearance of a floor on one day: painted walls, flooring and ceiling, and the panorama
// outside its windows.
#pragma once

#include <vector>

#include "base/monitor.h"
#include "synth/floor_plan.h"
#include "synth/surfaces.h"
#include "synth/world.h"

namespace vpr {

/// Texels of a wall with at least this daylight share are transparent.
inline constexpr int kGlassDaylight = 200;

struct Scene {
  FloorPlan plan;
  std::vector<Texture> walls;  ///< as plan.walls
  Texture floor;               ///< kPlanTexelsPerMeter from plan.origin, rows upwards
  Texture ceiling;
  Texture outside;         ///< a panorama; empty with far_view 0
  double far_view = 0;     ///< as in BuildingVariety
  double reflections = 0;  ///< as in BuildingVariety
};

/// Whether a wall has windows: some of the walls that face the outside do.
bool has_windows(const World& world, const FloorNames& names, const FloorPlan& plan, size_t wall);

/// A floor on one day; depends only on the world, the floor's index and the day. Walls are painted
/// in parallel.
Scene make_scene(const World& world, size_t floor, const Monitor& monitor, uint64_t day = 0);

}  // namespace vpr
