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
};

/// Depends on the world and the floor's index alone. Walls are painted in parallel.
Scene make_scene(const World& world, size_t floor, const Monitor& monitor);

}  // namespace vpr
