#include "synth/scene.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "base/parallel.h"
#include "synth/baked_light.h"
#include "synth/furnishing.h"
#include "synth/outside.h"
#include "synth/planes.h"

namespace vpr {
namespace {

// Of two floors alike, and of corridors alike, the same things stand in the same slots.
RandomEngine slot_style(const World& world, size_t floor, const FloorNames& names, size_t wall,
                        int slot) {
  RandomEngine choice =
      named_engine(world.seed, fmt::format("choice/{}/{}/{}", names.plan, wall, slot));
  if (uniform_unit(choice) < world.resemblance)
    return named_engine(world.seed, fmt::format("corridor/{}", slot));
  RandomEngine own_choice =
      named_engine(world.seed, fmt::format("own/{}/{}/{}", names.own, wall, slot));
  const bool like = uniform_unit(own_choice) < world.floors[floor].resemblance;
  return named_engine(world.seed,
                      fmt::format("wall/{}/{}/{}", like ? names.plan : names.own, wall, slot));
}

// Writing and papers, never alike; of slot -1 the wall itself.
RandomEngine slot_detail(const Setting& setting, size_t wall, int slot) {
  return named_engine(setting.world.seed,
                      fmt::format("detail/{}/{}/{}", setting.names.own, wall, slot));
}

bool is_in_hall(const FloorPlan& plan, const Wall& wall) {
  const Point way = wall_direction(wall.side);
  const Point inside{wall.start.x + way.x * 0.25 + way.y * 0.25,
                     wall.start.y + way.y * 0.25 - way.x * 0.25};
  const auto column = static_cast<size_t>((inside.x - plan.origin.x) / kPlanCellM);
  const auto row = static_cast<size_t>((inside.y - plan.origin.y) / kPlanCellM);
  return plan.open[row * static_cast<size_t>(plan.columns) + column] == 2;
}

// The finishes of the rooms that a wall passes; bricks go by the room at its middle.
void coat(const Setting& setting, const Wall& wall, WallBrush& brush) {
  const Point way = wall_direction(wall.side);
  const Point middle{wall.start.x + way.x * wall.length_m / 2 + way.y * 0.25,
                     wall.start.y + way.y * wall.length_m / 2 - way.x * 0.25};
  const Finish& most = setting.rooms[room_at(setting.planned, middle)];
  if (is_in_hall(setting.plan, wall) && most.brick_halls && !wall.is_pillar) {
    lay_bricks(brush, wall.length_m);
    return;
  }
  if (setting.world.variety.finishes == 0) {
    plaster(brush, most, 0, wall.length_m);
    return;
  }
  for (double from = 0; from < wall.length_m; from += kPlanCellM) {
    const double here = from + kPlanCellM / 2;
    const Point inside{wall.start.x + way.x * here + way.y * 0.25,
                       wall.start.y + way.y * here - way.x * 0.25};
    plaster(brush, setting.rooms[room_at(setting.planned, inside)], from, from + kPlanCellM);
  }
}

// What stands at a wall, slot by slot, and what of it is otherwise on this day.
void furnish(const Setting& setting, size_t index, bool in_hall, WallBrush& brush) {
  const World& world = setting.world;
  const bool windows = has_windows(world, setting.names, setting.plan, index);
  for (int slot = 0; (slot + 1) * kSlotM <= setting.plan.walls[index].length_m; ++slot) {
    brush.style = slot_style(world, setting.floor, setting.names, index, slot);
    brush.detail = slot_detail(setting, index, slot);
    brush.left_m = slot * kSlotM;
    RandomEngine emptiness =
        named_engine(world.seed, fmt::format("bare/{}/{}/{}", setting.names.own, index, slot));
    brush.is_bare = chance(emptiness, world.variety.bareness);
    brush.is_changed = false;
    if (setting.day != 0 && world.variety.changes > 0) {
      brush.day = named_engine(
          world.seed, fmt::format("day/{}/{}/{}/{}", setting.day, setting.names.own, index, slot));
      brush.is_changed = chance(brush.day, world.variety.changes);
      if (brush.is_changed && chance(brush.day, 0.5)) brush.detail = brush.day;
    }
    furnish_slot(brush, in_hall, windows);
  }
}

Texture paint_wall(const Setting& setting, size_t index) {
  const Wall& wall = setting.plan.walls[index];
  cv::Mat picture(static_cast<int>(std::lround(kRoomHeightM * kTexelsPerMetre)),
                  static_cast<int>(std::lround(wall.length_m * kTexelsPerMetre)), CV_8UC4,
                  cv::Scalar(0));
  WallBrush brush{picture, named_engine(0, ""), slot_detail(setting, index, -1)};
  const bool in_hall = is_in_hall(setting.plan, wall);
  if (wall.is_glass) {
    paint_glass_front(brush);
  } else {
    coat(setting, wall, brush);
    roughen(picture, brush.detail, 3, 7);
    RandomEngine marks =
        named_engine(setting.world.seed, fmt::format("wear/{}/{}", setting.names.own, index));
    wear_wall(brush, wall.length_m, setting.world.variety.wear, marks);
    furnish(setting, index, in_hall, brush);
    brush.left_m = 0;
    brush.fill(0, 0, wall.length_m, 0.08, colour(60, 62, 65));  // skirting
  }
  light_wall(setting, wall, picture);
  return make_wall_texture(picture);
}

}  // namespace

Scene make_scene(const World& world, size_t floor, const Monitor& monitor, uint64_t day) {
  const Floor& planned = plan_floor(world, floor);
  const FloorNames names{world.floors[floor].name, planned.name};
  Scene scene;
  scene.plan = make_floor_plan(planned);
  std::vector<Finish> rooms;
  for (size_t i = 0; i < planned.rooms.size(); ++i) rooms.push_back(room_finish(world, names, i));
  for (Lamp& lamp : scene.plan.lamps) lamp.power = rooms[lamp.room].lamps;
  const Setting setting{
      world, floor, planned, names, scene.plan, rooms, daylight_sources(world, names, scene.plan),
      day};
  scene.walls.resize(scene.plan.walls.size());
  parallel_for(scene.walls.size(), monitor,
               [&](size_t i) { scene.walls[i] = paint_wall(setting, i); });
  const Baked light = light_map(setting, monitor);
  scene.floor = paint_floor(setting, light);
  scene.ceiling = paint_ceiling(setting, light);
  scene.far_view = world.variety.far_view;
  scene.reflections = world.variety.reflections;
  if (scene.far_view > 0) scene.outside = make_panorama(world.seed);
  return scene;
}

}  // namespace vpr
