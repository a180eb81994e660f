#include "synth/scene.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"

namespace vpr {
namespace {

/// One meter of glass, seen from the room.
struct DaylightSource {
  Point at;
  Point inward;  ///< unit vector
  double strength = 1;
};

/// A floor on one day, as input of the painting functions.
struct FloorDay {
  const World& world;
  size_t floor;
  const Floor& planned;  ///< the floor that has the plan
  const FloorNames& names;
  const FloorPlan& plan;
  const std::vector<Finish>& rooms;
  std::vector<DaylightSource> daylight;
  uint64_t day;
};

/// The light on the texels of a surface, and its daylight share.
struct BakedLight {
  cv::Mat light;     ///< CV_32F
  cv::Mat daylight;  ///< CV_32F, empty without daylight
};

constexpr double kReachM = 14;
constexpr double kInFrontM = 0.3;         // distance from the glass
constexpr double kShareOfWindows = 0.35;  // of a wall with windows
constexpr double kAmbientLight = 0.38;
constexpr double kLampReachM = 8;
constexpr double kLightStepM = 0.25;  // resolution of the baked light

// The daylight at a point, in units of the light of lamps.
double daylight_at(const FloorPlan& plan, const std::vector<DaylightSource>& sources, Point point) {
  double light = 0;
  for (const DaylightSource& source : sources) {
    const Point way = point - source.at;
    const double square = way.dot(way);
    if (square > kReachM * kReachM) continue;
    const double toward =
        (way.dot(source.inward) + kInFrontM) / std::sqrt(square + kInFrontM * kInFrontM);
    if (toward > 0 && can_see(plan, point, source.at))
      light += source.strength * std::min(1.0, toward) / (1 + square);
  }
  return light;
}

double light_at(const FloorPlan& plan, Point point) {
  double light = kAmbientLight;
  for (const Lamp& lamp : plan.lamps) {
    const Point way = lamp.at - point;
    const double square = way.dot(way);
    if (square < kLampReachM * kLampReachM && can_see(plan, point, lamp.at))
      light += lamp.power * 1.5 / (1.6 + square);
  }
  return light;
}

uint8_t daylight_share(float daylight, float light) {
  return static_cast<uint8_t>(std::min<double>(kGlassDaylight - 1, 255 * daylight / light));
}

BakedLight bake_along(const FloorDay& floor_day, const Wall& wall, int texels) {
  const int steps = std::max(2, static_cast<int>(wall.length_m / kLightStepM));
  cv::Mat light(1, steps, CV_32F), daylight(1, steps, CV_32F);
  for (int i = 0; i < steps; ++i) {
    const double meters = (i + 0.5) * wall.length_m / steps;
    const double corner = std::min(meters, wall.length_m - meters);
    const Point p = wall.at(meters, 0.05);
    daylight.at<float>(0, i) =
        static_cast<float>(daylight_at(floor_day.plan, floor_day.daylight, p));
    const double all = light_at(floor_day.plan, p) + daylight.at<float>(0, i);
    light.at<float>(0, i) = static_cast<float>(all * (1 - 0.25 * std::exp(-corner / 0.3)));
  }
  cv::resize(light, light, {texels, 1}, 0, 0, cv::INTER_LINEAR);
  cv::resize(daylight, daylight, {texels, 1}, 0, 0, cv::INTER_LINEAR);
  return {light, floor_day.daylight.empty() ? cv::Mat() : daylight};
}

// All glass of a floor, scaled by variety.window_light; empty if that is 0.
std::vector<DaylightSource> daylight_sources(const World& world, const FloorNames& names,
                                             const FloorPlan& plan) {
  std::vector<DaylightSource> sources;
  if (world.variety.window_light == 0) return sources;
  for (size_t i = 0; i < plan.walls.size(); ++i) {
    const Wall& wall = plan.walls[i];
    if (!wall.is_glass && !has_windows(world, names, plan, i)) continue;
    const Point way = wall.direction(), inward{way.y, -way.x};
    const double share = wall.is_glass ? 1 : kShareOfWindows;
    const int pieces = std::max(1, static_cast<int>(wall.length_m));
    for (int piece = 0; piece < pieces; ++piece) {
      const double along = (piece + 0.5) * wall.length_m / pieces;
      sources.push_back({wall.at(along, kInFrontM), inward,
                         world.variety.window_light * share * wall.length_m / pieces});
    }
  }
  return sources;
}

// Applies lamps and daylight to the image of a wall, with darker corners and less light near the
// floor. Windows are light sources themselves.
void light_wall(const FloorDay& floor_day, const Wall& wall, cv::Mat& picture) {
  const BakedLight along = bake_along(floor_day, wall, picture.cols);
  for (int y = 0; y < picture.rows; ++y) {
    const double height = 1 - static_cast<double>(y) / picture.rows;
    const double vertical = 0.74 + 0.32 * height - 0.2 * std::exp(-height / 0.04);
    for (int x = 0; x < picture.cols; ++x) {
      auto& texel = picture.at<cv::Vec4b>(y, x);
      if (texel[3] != 0) continue;
      const float light = along.light.at<float>(0, x);
      for (int c = 0; c < 3; ++c)
        texel[c] = cv::saturate_cast<uint8_t>(texel[c] * vertical * light);
      if (!along.daylight.empty()) texel[3] = daylight_share(along.daylight.at<float>(0, x), light);
    }
  }
}

// The light on a floor plan, with a resolution of a quarter of a meter.
BakedLight light_map(const FloorDay& floor_day, const Monitor& monitor) {
  const FloorPlan& plan = floor_day.plan;
  cv::Mat map(plan.rows * 2, plan.columns * 2, CV_32F, cv::Scalar(kAmbientLight));
  cv::Mat daylight(map.size(), CV_32F, cv::Scalar(0));
  parallel_for(static_cast<size_t>(map.rows), monitor, [&](size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < map.cols; ++x) {
      const Point p = plan.origin + kLightStepM * Point(x + 0.5, y + 0.5);
      if (!plan.is_open(p)) continue;
      const double day = daylight_at(plan, floor_day.daylight, p);
      daylight.at<float>(y, x) = static_cast<float>(day);
      map.at<float>(y, x) = static_cast<float>(light_at(plan, p) + day);
    }
  });
  return {map, floor_day.daylight.empty() ? cv::Mat() : daylight};
}

// Applies light, scaled by `factor`, to the image of a floor or ceiling.
void shade(cv::Mat& picture, const BakedLight& baked, double factor) {
  cv::Mat light, daylight;
  cv::resize(baked.light, light, picture.size(), 0, 0, cv::INTER_LINEAR);
  if (!baked.daylight.empty())
    cv::resize(baked.daylight, daylight, picture.size(), 0, 0, cv::INTER_LINEAR);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      auto& texel = picture.at<cv::Vec4b>(y, x);
      for (int c = 0; c < 3; ++c)
        texel[c] = cv::saturate_cast<uint8_t>(texel[c] * light.at<float>(y, x) * factor);
      if (!daylight.empty())
        texel[3] = daylight_share(daylight.at<float>(y, x), light.at<float>(y, x));
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
  return plan.open_at(wall.at(0.25, 0.25)) == 2;
}

// The finishes of the rooms along a wall; bricks follow the room at its middle.
void coat(const FloorDay& floor_day, const Wall& wall, WallBrush& brush) {
  const auto finish_at = [&](double along_m) -> const Finish& {
    return floor_day.rooms[room_at(floor_day.planned, wall.at(along_m, 0.25))];
  };
  const Finish& most = finish_at(wall.length_m / 2);
  if (is_in_hall(floor_day.plan, wall) && most.brick_halls && !wall.is_pillar) {
    lay_bricks(brush, wall.length_m);
    return;
  }
  if (floor_day.world.variety.finishes == 0) {
    plaster(brush, most, 0, wall.length_m);
    return;
  }
  for (double from = 0; from < wall.length_m; from += kPlanCellM)
    plaster(brush, finish_at(from + kPlanCellM / 2), from, from + kPlanCellM);
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
  cv::Mat picture(wall_texels(kRoomHeightM), wall_texels(wall.length_m), CV_8UC4, cv::Scalar(0));
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

// Calls paint(finish, part of the image) for every room with its own finish: corridors first, halls
// over them.
template <class Painter>
void for_rooms(const FloorDay& floor_day, Painter&& paint) {
  if (floor_day.world.variety.finishes == 0) return;
  const auto texels = [](double meters) {
    return static_cast<int>(std::lround(meters * kPlanTexelsPerMeter));
  };
  for (const RoomKind kind : {RoomKind::corridor, RoomKind::hall})
    for (size_t i = 0; i < floor_day.planned.rooms.size(); ++i) {
      const Room& room = floor_day.planned.rooms[i];
      if (room.kind != kind) continue;
      paint(floor_day.rooms[i], cv::Rect(texels(room.x - floor_day.plan.origin.x),
                                         texels(room.y - floor_day.plan.origin.y),
                                         texels(room.width), texels(room.depth)));
    }
}

Texture paint_floor(const FloorDay& floor_day, const BakedLight& light) {
  RandomEngine engine = named_engine(floor_day.world.seed, "ground/" + floor_day.names.plan);
  cv::Mat picture = plan_picture(floor_day.plan);
  const double tone = between(engine, 95, 150);
  const double red = tone * between(engine, 1, 1.12);
  const cv::Scalar base = color(tone * between(engine, 0.8, 1), tone, red);
  const cv::Rect whole(0, 0, picture.cols, picture.rows);
  lay_tiles(picture, whole, kTile, engine, base, 0.06, base * 0.72);
  for_rooms(floor_day, [&](const Finish& finish, const cv::Rect& part) {
    const cv::Scalar own = base * finish.flooring;
    const int tile = static_cast<int>(finish.flooring_tile_m * kPlanTexelsPerMeter);
    lay_tiles(picture, part, tile, engine, own, 0.06, own * 0.72);
    const int border = 2 * static_cast<int>(0.35 * kPlanTexelsPerMeter);
    if (finish.has_runner) cv::rectangle(picture, part, own * 0.45, border);
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
  const cv::Scalar base = color(196, 204, 206);
  lay_tiles(picture, cv::Rect(0, 0, picture.cols, picture.rows), kTile, engine, base, 0.02,
            color(130, 136, 138));
  for_rooms(floor_day, [&](const Finish& finish, const cv::Rect& part) {
    const cv::Scalar own = base * finish.ceiling;
    lay_tiles(picture, part, kTile, engine, own, 0.02, own * 0.66);
    const int step = kTile / 3;
    if (!finish.has_slats) return;
    for (int y = part.y; y < part.y + part.height; y += step)
      cv::rectangle(picture, cv::Rect(part.x, y, part.width, step / 2), own * 0.5, cv::FILLED);
  });
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

// The distance between the lamps of a room that differs from its twin on another floor; nullopt
// for any other room.
std::optional<double> renovated_lamps(const World& world, size_t floor, size_t room) {
  const Floor& own = world.floors[floor];
  if (own.renovated == 0) return std::nullopt;
  RandomEngine engine = named_engine(world.seed, fmt::format("renovated/{}/{}", own.name, room));
  if (!chance(engine, own.renovated)) return std::nullopt;
  return between(engine, 2, 4.5);
}

}  // namespace

bool has_windows(const World& world, const FloorNames& names, const FloorPlan& plan, size_t index) {
  RandomEngine building = named_engine(world.seed, fmt::format("windows/{}/{}", names.plan, index));
  if (uniform_unit(building) >= 0.4) return false;
  const Wall& wall = plan.walls[index];
  for (double meters = 0.25; meters < 500; meters += kPlanCellM)
    if (plan.is_open(wall.at(wall.length_m / 2, -meters))) return false;
  return true;
}

Scene make_scene(const World& world, size_t floor, const Monitor& monitor, uint64_t day) {
  Floor planned = plan_floor(world, floor);
  const FloorNames names{world.floors[floor].name, planned.name};
  std::vector<Finish> rooms;
  for (size_t i = 0; i < planned.rooms.size(); ++i) {
    const auto lamps = renovated_lamps(world, floor, i);
    if (lamps) planned.rooms[i].lamp_spacing_m = *lamps;
    rooms.push_back(room_finish(world, lamps ? FloorNames{names.own, names.own} : names, i));
  }
  Scene scene;
  scene.plan = make_floor_plan(planned);
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
