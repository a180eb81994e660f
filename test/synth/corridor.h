// Two corridors and walks through them, for tests of how one walks and holds a phone.
#pragma once

#include <vector>

#include "synth/walking.h"

namespace vpr::test {

/// Two corridors that meet at a corner, seen at 10 frames a second.
inline World corridor_world() {
  World world;
  world.fps = 10;
  Floor floor;
  floor.name = "f";
  floor.rooms = {{RoomKind::corridor, 0, 0, 20, 3}, {RoomKind::corridor, 17, 0, 3, 12}};
  world.floors = {floor};
  return world;
}

/// A walk of that world.
inline Walk walk_along(const std::vector<std::vector<double>>& path, uint64_t frames) {
  Walk walk;
  walk.name = "w";
  walk.floor = "f";
  walk.path = path;
  walk.frames = frames;
  return walk;
}

/// The poses of a walk on the world's first floor.
inline std::vector<CameraPose> poses(const World& world, const Walk& walk) {
  return walk_poses(world, walk, make_floor_plan(world.floors[0]));
}

/// 15 m along x at 1.2 m/s, without shake.
inline Walk straight_walk() {
  Walk walk = walk_along({{1, 1.5}, {16, 1.5}}, 0);
  walk.shake = 0;
  return walk;
}

/// Metres from the frame before to this one.
inline double step_m(const std::vector<CameraPose>& found, size_t i) {
  return found[i].way_m - found[i - 1].way_m;
}

}  // namespace vpr::test
