#include "synth/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "synth/daylight.h"
#include "synth/furnishing.h"
#include "synth/surfaces.h"

namespace vpr {
namespace {

constexpr int kAround = 4096;  // texels
constexpr int kHigh = 1024;    // for tangents from 1 to -1
constexpr int kHorizon = kHigh / 2;
constexpr double kOpen = 255;  // daylight share of the outside

cv::Scalar shine(double blue, double green, double red) { return {blue, green, red, kOpen}; }

void paint_house(cv::Mat& picture, RandomEngine& engine) {
  const int left = static_cast<int>(uniform_below(engine, kAround));
  const int width = static_cast<int>(between(engine, 120, 420));
  const int height = static_cast<int>(between(engine, 40, 190));
  const double tone = between(engine, 70, 200);
  const cv::Scalar front = shine(tone * between(engine, 0.8, 1), tone * 0.97, tone);
  cv::rectangle(picture, cv::Rect(left, kHorizon - height, width, height + 30), front, cv::FILLED);
  const double dark = between(engine, 0.35, 0.7);
  for (int y = kHorizon - height + 12; y < kHorizon; y += 26)
    for (int x = left + 10; x + 12 < left + width; x += 24)
      cv::rectangle(picture, cv::Rect(x, y, 12, 15),
                    shine(front[0] * dark, front[1] * dark, front[2] * dark), cv::FILLED);
}

void paint_tree(cv::Mat& picture, RandomEngine& engine) {
  const int x = static_cast<int>(uniform_below(engine, kAround));
  const int size = static_cast<int>(between(engine, 20, 85));
  for (int i = 0; i < 14; ++i) {
    const double shade = between(engine, 50, 130);
    const int up = static_cast<int>(between(engine, 0, size));
    const int aside = static_cast<int>(between(engine, -size, size));
    const cv::Point leaf(x + aside, kHorizon - size / 2 - up);
    cv::circle(picture, leaf, size / 3 + 2, shine(shade * 0.55, shade, shade * 0.75), cv::FILLED);
  }
}

// Similar floors and corridors have the same objects in the same slots.
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

// Text and papers, which always differ; slot -1 is the wall itself.
RandomEngine slot_detail(const FloorDay& floor_day, size_t wall, int slot) {
  return named_engine(floor_day.world.seed,
                      fmt::format("detail/{}/{}/{}", floor_day.names.own, wall, slot));
}

bool is_in_hall(const FloorPlan& plan, const Wall& wall) {
  const Point way = wall_direction(wall.side);
  const Point inside{wall.start.x + way.x * 0.25 + way.y * 0.25,
                     wall.start.y + way.y * 0.25 - way.x * 0.25};
  const auto column = static_cast<size_t>((inside.x - plan.origin.x) / kPlanCellM);
  const auto row = static_cast<size_t>((inside.y - plan.origin.y) / kPlanCellM);
  return plan.open[row * static_cast<size_t>(plan.columns) + column] == 2;
}

// The finishes of the rooms along a wall; bricks follow the room at its middle.
void coat(const FloorDay& floor_day, const Wall& wall, WallBrush& brush) {
  const Point way = wall_direction(wall.side);
  const Point middle{wall.start.x + way.x * wall.length_m / 2 + way.y * 0.25,
                     wall.start.y + way.y * wall.length_m / 2 - way.x * 0.25};
  const Finish& most = floor_day.rooms[room_at(floor_day.planned, middle)];
  if (is_in_hall(floor_day.plan, wall) && most.brick_halls && !wall.is_pillar) {
    lay_bricks(brush, wall.length_m);
    return;
  }
  if (floor_day.world.variety.finishes == 0) {
    plaster(brush, most, 0, wall.length_m);
    return;
  }
  for (double from = 0; from < wall.length_m; from += kPlanCellM) {
    const double here = from + kPlanCellM / 2;
    const Point inside{wall.start.x + way.x * here + way.y * 0.25,
                       wall.start.y + way.y * here - way.x * 0.25};
    plaster(brush, floor_day.rooms[room_at(floor_day.planned, inside)], from, from + kPlanCellM);
  }
}

// Furnishes a wall slot by slot, including the changes of this day.
void furnish(const FloorDay& floor_day, size_t index, bool in_hall, WallBrush& brush) {
  const World& world = floor_day.world;
  const bool windows = has_windows(world, floor_day.names, floor_day.plan, index);
  for (int slot = 0; (slot + 1) * kSlotM <= floor_day.plan.walls[index].length_m; ++slot) {
    brush.style = slot_style(world, floor_day.floor, floor_day.names, index, slot);
    brush.detail = slot_detail(floor_day, index, slot);
    brush.left_m = slot * kSlotM;
    RandomEngine emptiness =
        named_engine(world.seed, fmt::format("bare/{}/{}/{}", floor_day.names.own, index, slot));
    brush.is_bare = chance(emptiness, world.variety.bareness);
    brush.is_changed = false;
    if (floor_day.day != 0 && world.variety.changes > 0) {
      brush.day = named_engine(world.seed, fmt::format("day/{}/{}/{}/{}", floor_day.day,
                                                       floor_day.names.own, index, slot));
      brush.is_changed = chance(brush.day, world.variety.changes);
      if (brush.is_changed && chance(brush.day, 0.5)) brush.detail = brush.day;
    }
    furnish_slot(brush, in_hall, windows);
  }
}

Texture paint_wall(const FloorDay& floor_day, size_t index) {
  const Wall& wall = floor_day.plan.walls[index];
  cv::Mat picture(static_cast<int>(std::lround(kRoomHeightM * kTexelsPerMeter)),
                  static_cast<int>(std::lround(wall.length_m * kTexelsPerMeter)), CV_8UC4,
                  cv::Scalar(0));
  WallBrush brush{picture, named_engine(0, ""), slot_detail(floor_day, index, -1)};
  const bool in_hall = is_in_hall(floor_day.plan, wall);
  if (wall.is_glass) {
    paint_glass_front(brush);
  } else {
    coat(floor_day, wall, brush);
    roughen(picture, brush.detail, 3, 7);
    RandomEngine marks =
        named_engine(floor_day.world.seed, fmt::format("wear/{}/{}", floor_day.names.own, index));
    wear_wall(brush, wall.length_m, floor_day.world.variety.wear, marks);
    furnish(floor_day, index, in_hall, brush);
    brush.left_m = 0;
    brush.fill(0, 0, wall.length_m, 0.08, color(60, 62, 65));  // skirting
  }
  light_wall(floor_day, wall, picture);
  return make_wall_texture(picture);
}

constexpr int kTile = static_cast<int>(0.6 * kPlanTexelsPerMeter);

cv::Mat plan_picture(const FloorPlan& plan) {
  const int cell = static_cast<int>(kPlanCellM * kPlanTexelsPerMeter);
  return cv::Mat(plan.rows * cell, plan.columns * cell, CV_8UC4, cv::Scalar(0));
}

cv::Rect room_on_plan(const Room& room, const FloorPlan& plan) {
  const auto texels = [](double meters) {
    return static_cast<int>(std::lround(meters * kPlanTexelsPerMeter));
  };
  return {texels(room.x - plan.origin.x), texels(room.y - plan.origin.y), texels(room.width),
          texels(room.depth)};
}

// Calls `paint` for every room with its own finish: corridors first, halls over them.
template <class Painter>
void for_rooms(const FloorDay& floor_day, cv::Mat& picture, Painter&& paint) {
  if (floor_day.world.variety.finishes == 0) return;
  for (const RoomKind kind : {RoomKind::corridor, RoomKind::hall})
    for (size_t i = 0; i < floor_day.planned.rooms.size(); ++i) {
      const Room& room = floor_day.planned.rooms[i];
      if (room.kind == kind) paint(floor_day.rooms[i], picture, room_on_plan(room, floor_day.plan));
    }
}

void hang_ceilings(const FloorDay& floor_day, cv::Mat& picture, RandomEngine& engine) {
  const cv::Scalar base = color(196, 204, 206);
  lay_tiles(picture, cv::Rect(0, 0, picture.cols, picture.rows), kTile, engine, base, 0.02,
            color(130, 136, 138));
  for_rooms(floor_day, picture, [&](const Finish& finish, cv::Mat& all, const cv::Rect& part) {
    const cv::Scalar own = base * finish.ceiling;
    lay_tiles(all, part, kTile, engine, own, 0.02, own * 0.66);
    const int step = kTile / 3;
    if (!finish.has_slats) return;
    for (int y = part.y; y < part.y + part.height; y += step)
      cv::rectangle(all, cv::Rect(part.x, y, part.width, step / 2), own * 0.5, cv::FILLED);
  });
}

Texture paint_floor(const FloorDay& floor_day, const BakedLight& light) {
  RandomEngine engine = named_engine(floor_day.world.seed, "ground/" + floor_day.names.plan);
  cv::Mat picture = plan_picture(floor_day.plan);
  const double tone = between(engine, 95, 150);
  const double red = tone * between(engine, 1, 1.12);
  const cv::Scalar base = color(tone * between(engine, 0.8, 1), tone, red);
  const cv::Rect whole(0, 0, picture.cols, picture.rows);
  lay_tiles(picture, whole, kTile, engine, base, 0.06, base * 0.72);
  for_rooms(floor_day, picture, [&](const Finish& finish, cv::Mat& all, const cv::Rect& part) {
    const cv::Scalar own = base * finish.flooring;
    const int tile = static_cast<int>(finish.flooring_tile_m * kPlanTexelsPerMeter);
    lay_tiles(all, part, tile, engine, own, 0.06, own * 0.72);
    const int border = 2 * static_cast<int>(0.35 * kPlanTexelsPerMeter);
    if (finish.has_runner) cv::rectangle(all, part, own * 0.45, border);
  });
  RandomEngine detail = named_engine(floor_day.world.seed, "dirt/" + floor_day.names.own);
  roughen(picture, detail, 9, 9);
  shade(picture, light, 0.95);
  return make_texture(picture);
}

Texture paint_ceiling(const FloorDay& floor_day, const BakedLight& light) {
  const FloorPlan& plan = floor_day.plan;
  RandomEngine engine = named_engine(floor_day.world.seed, "ceiling/" + floor_day.names.plan);
  cv::Mat picture = plan_picture(plan);
  hang_ceilings(floor_day, picture, engine);
  RandomEngine detail = named_engine(floor_day.world.seed, "ceiling-detail/" + floor_day.names.own);
  roughen(picture, detail, 6, 4);
  for (int i = 0; i < plan.rows * plan.columns / 20; ++i)  // detectors and nozzles
    cv::circle(picture,
               {static_cast<int>(uniform_below(detail, static_cast<uint64_t>(picture.cols))),
                static_cast<int>(uniform_below(detail, static_cast<uint64_t>(picture.rows)))},
               4, color(90, 92, 95), cv::FILLED);
  shade(picture, light, 0.72);
  for (const Lamp& lamp : plan.lamps) {
    if (uniform_unit(detail) < 0.06) continue;  // a broken lamp
    const auto x = static_cast<int>((lamp.at.x - plan.origin.x - 0.6) * kPlanTexelsPerMeter);
    const auto y = static_cast<int>((lamp.at.y - plan.origin.y - 0.3) * kPlanTexelsPerMeter);
    cv::rectangle(picture, cv::Rect(x, y, 2 * kTile, kTile), color(255, 255, 255), cv::FILLED);
    for (int bar = kTile / 2; bar < 2 * kTile; bar += kTile / 2)
      cv::line(picture, {x + bar, y}, {x + bar, y + kTile}, color(215, 220, 222));
  }
  return make_texture(picture);
}

}  // namespace

Texture make_panorama(uint64_t seed) {
  RandomEngine engine = named_engine(seed, "outside");
  cv::Mat picture(kHigh, kAround, CV_8UC4);
  for (int y = 0; y < kHigh; ++y) {
    const double up = static_cast<double>(kHorizon - y) / kHorizon;
    picture.row(y).setTo(up > 0 ? shine(250 - 20 * up, 240 - 45 * up, 232 - 80 * up)
                                : shine(95 + 30 * up, 125 + 30 * up, 118 + 30 * up));
  }
  for (int i = 0; i < 16; ++i) {  // clouds
    const int down = static_cast<int>(between(engine, 0, 0.6 * kHorizon));
    const cv::Point middle(static_cast<int>(uniform_below(engine, kAround)), down);
    cv::ellipse(
        picture, middle,
        {static_cast<int>(between(engine, 80, 300)), static_cast<int>(between(engine, 15, 50))}, 0,
        0, 360, shine(246, 244, 240), cv::FILLED, cv::LINE_AA);
  }
  for (int i = 0; i < 20; ++i) paint_house(picture, engine);
  for (int i = 0; i < 40; ++i) paint_tree(picture, engine);
  return make_wall_texture(picture);
}

void panorama_strip(const Texture& panorama, Point direction, double pixel_rad,
                    std::vector<cv::Vec4b>& strip) {
  const double turn = std::atan2(direction.y, direction.x) / (2 * std::numbers::pi);
  const double texels = pixel_rad / (2 * std::numbers::pi) * kAround;
  // Clockwise, in the direction of a turn to the right.
  filter_strip(panorama, choose_level(panorama, texels), (0.5 - turn) * kAround,
               std::max(1.0, texels), strip);
}

Scene make_scene(const World& world, size_t floor, const Monitor& monitor, uint64_t day) {
  const Floor& planned = plan_floor(world, floor);
  const FloorNames names{world.floors[floor].name, planned.name};
  Scene scene;
  scene.plan = make_floor_plan(planned);
  std::vector<Finish> rooms;
  for (size_t i = 0; i < planned.rooms.size(); ++i) rooms.push_back(room_finish(world, names, i));
  for (Lamp& lamp : scene.plan.lamps) lamp.power = rooms[lamp.room].lamps;
  const FloorDay floor_day{
      world, floor, planned, names, scene.plan, rooms, daylight_sources(world, names, scene.plan),
      day};
  scene.walls.resize(scene.plan.walls.size());
  parallel_for(scene.walls.size(), monitor,
               [&](size_t i) { scene.walls[i] = paint_wall(floor_day, i); });
  const BakedLight light = light_map(floor_day, monitor);
  scene.floor = paint_floor(floor_day, light);
  scene.ceiling = paint_ceiling(floor_day, light);
  scene.far_view = world.variety.far_view;
  scene.reflections = world.variety.reflections;
  if (scene.far_view > 0) scene.outside = make_panorama(world.seed);
  return scene;
}

}  // namespace vpr
