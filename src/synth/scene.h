// A floor of a building, painted and lit: what the renderer looks up.
#pragma once

#include <vector>

#include "base/monitor.h"
#include "synth/floor_plan.h"
#include "synth/texture.h"
#include "synth/world.h"

namespace vpr {

/// What one floor looks like.
struct Scene {
  FloorPlan plan;
  std::vector<Texture> walls;  ///< as plan.walls
  Texture floor;               ///< kPlanTexelsPerMetre from plan.origin, rows upwards
  Texture ceiling;
  Texture outside;         ///< a panorama; empty with far_view 0
  double far_view = 0;     ///< as in BuildingVariety
  double reflections = 0;  ///< as in BuildingVariety
};

/// A floor as it is on a day; depends on the world, the floor's index and the day alone. Walls are
/// painted in parallel.
Scene make_scene(const World& world, size_t floor, const Monitor& monitor, uint64_t day = 0);

}  // namespace vpr
