#include "synth/scene.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "synth/furnishing.h"

namespace vpr {
namespace {

constexpr double kAmbientLight = 0.38;
constexpr double kLampReachM = 8;
constexpr double kLightStepM = 0.25;  // of baked light

/// Names of the two floors that matter: the own one, and the one whose plan it has.
struct FloorNames {
  std::string own;
  std::string plan;
};

struct Finish {  // colours that a building has throughout
  cv::Scalar plaster;
  cv::Scalar dado;  // the lower part of a wall
  double dado_m = 0;
  bool brick_halls = false;
};

Finish building_finish(const World& world, const FloorNames& names) {
  RandomEngine engine = named_engine(world.seed, "building");
  RandomEngine own = named_engine(world.seed, "floor/" + names.plan);
  const double tone = between(engine, 165, 205) + between(own, -12, 12);
  Finish finish;
  finish.plaster =
      colour(tone * between(engine, 0.86, 0.98), tone, tone * between(engine, 0.98, 1.05));
  finish.dado =
      colour(between(engine, 90, 150), between(engine, 100, 150), between(engine, 95, 150));
  finish.dado_m = between(engine, 0.9, 1.2);
  finish.brick_halls = uniform_unit(own) < 0.5;
  return finish;
}

// Speckle and stains: `fine` grey values from texel to texel, `coarse` over decimetres.
void roughen(cv::Mat& picture, RandomEngine& engine, int fine, double coarse) {
  cv::Mat small(picture.rows / 48 + 2, picture.cols / 48 + 2, CV_32F);
  for (int y = 0; y < small.rows; ++y)
    for (int x = 0; x < small.cols; ++x)
      small.at<float>(y, x) = static_cast<float>(between(engine, -coarse, coarse));
  cv::Mat stains;
  cv::resize(small, stains, picture.size(), 0, 0, cv::INTER_CUBIC);
  uint64_t bits = 0;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      if (x % 8 == 0) bits = engine();
      const int speckle = static_cast<int>(bits & 0xff) * (2 * fine + 1) / 256 - fine;
      bits >>= 8;
      const int change = speckle + static_cast<int>(std::lround(stains.at<float>(y, x)));
      for (int c = 0; c < 3; ++c) {
        uint8_t& value = picture.at<cv::Vec4b>(y, x)[c];
        value = cv::saturate_cast<uint8_t>(value + change);
      }
    }
}

void lay_bricks(WallBrush& brush, double length_m) {
  constexpr double kBrick = 0.25, kCourse = 0.083, kJoint = 0.012;
  brush.fill(0, 0, length_m, kRoomHeightM, colour(140, 150, 155));
  int course = 0;
  for (double z = 0; z < kRoomHeightM; z += kCourse, ++course)
    for (double x = course % 2 == 0 ? 0 : -kBrick / 2; x < length_m; x += kBrick) {
      const double shade = between(brush.detail, 0.8, 1.15);
      brush.fill(x, z, kBrick - kJoint, kCourse - kJoint,
                 colour(62 * shade, 78 * shade, 140 * shade));
    }
}

void plaster(WallBrush& brush, const Finish& finish, double length_m) {
  brush.fill(0, 0, length_m, kRoomHeightM, finish.plaster);
  brush.fill(0, 0, length_m, finish.dado_m, finish.dado);
  brush.fill(0, finish.dado_m, length_m, 0.03, colour(70, 75, 80));
}

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

bool is_in_hall(const FloorPlan& plan, const Wall& wall) {
  const Point way = wall_direction(wall.side);
  const Point inside{wall.start.x + way.x * 0.25 + way.y * 0.25,
                     wall.start.y + way.y * 0.25 - way.x * 0.25};
  const auto column = static_cast<size_t>((inside.x - plan.origin.x) / kPlanCellM);
  const auto row = static_cast<size_t>((inside.y - plan.origin.y) / kPlanCellM);
  return plan.open[row * static_cast<size_t>(plan.columns) + column] == 2;
}

// Whether nothing but the outside lies behind the middle of a wall.
bool is_outer(const FloorPlan& plan, const Wall& wall) {
  const Point way = wall_direction(wall.side);
  const Point out{-way.y, way.x};
  Point p{wall.start.x + way.x * wall.length_m / 2, wall.start.y + way.y * wall.length_m / 2};
  for (double metres = 0.25; metres < 500; metres += kPlanCellM)
    if (plan.is_open({p.x + out.x * metres, p.y + out.y * metres})) return false;
  return true;
}

double light_at(const FloorPlan& plan, Point point) {
  double light = kAmbientLight;
  for (const Point& lamp : plan.lamps) {
    const double dx = lamp.x - point.x, dy = lamp.y - point.y, square = dx * dx + dy * dy;
    if (square < kLampReachM * kLampReachM && can_see(plan, point, lamp))
      light += 1.5 / (1.6 + square);
  }
  return light;
}

// Lamps, darker corners, and less light near the floor; windows shine by themselves.
void light_wall(const FloorPlan& plan, const Wall& wall, cv::Mat& picture) {
  const Point way = wall_direction(wall.side);
  const int steps = std::max(2, static_cast<int>(wall.length_m / kLightStepM));
  cv::Mat along(1, steps, CV_32F);
  for (int i = 0; i < steps; ++i) {
    const double metres = (i + 0.5) * wall.length_m / steps;
    const double corner = std::min(metres, wall.length_m - metres);
    const Point p{wall.start.x + way.x * metres + way.y * 0.05,
                  wall.start.y + way.y * metres - way.x * 0.05};
    along.at<float>(0, i) =
        static_cast<float>(light_at(plan, p) * (1 - 0.25 * std::exp(-corner / 0.3)));
  }
  cv::resize(along, along, {picture.cols, 1}, 0, 0, cv::INTER_LINEAR);
  for (int y = 0; y < picture.rows; ++y) {
    const double height = 1 - static_cast<double>(y) / picture.rows;
    const double vertical = 0.74 + 0.32 * height - 0.2 * std::exp(-height / 0.04);
    for (int x = 0; x < picture.cols; ++x) {
      auto& texel = picture.at<cv::Vec4b>(y, x);
      if (texel[3] != 0) continue;
      for (int c = 0; c < 3; ++c)
        texel[c] = cv::saturate_cast<uint8_t>(texel[c] * vertical * along.at<float>(0, x));
    }
  }
}

Texture paint_wall(const World& world, size_t floor, const FloorNames& names, const Finish& finish,
                   const FloorPlan& plan, size_t index) {
  const Wall& wall = plan.walls[index];
  cv::Mat picture(static_cast<int>(std::lround(kRoomHeightM * kTexelsPerMetre)),
                  static_cast<int>(std::lround(wall.length_m * kTexelsPerMetre)), CV_8UC4,
                  cv::Scalar(0));
  const auto detail = [&](int slot) {
    return named_engine(world.seed, fmt::format("detail/{}/{}/{}", names.own, index, slot));
  };
  WallBrush brush{picture, named_engine(0, ""), detail(-1)};
  const bool in_hall = is_in_hall(plan, wall);
  if (wall.is_glass) {
    paint_glass_front(brush);
  } else {
    if (in_hall && finish.brick_halls && !wall.is_pillar) {
      lay_bricks(brush, wall.length_m);
    } else {
      plaster(brush, finish, wall.length_m);
    }
    roughen(picture, brush.detail, 3, 7);
    RandomEngine building =
        named_engine(world.seed, fmt::format("windows/{}/{}", names.plan, index));
    const bool has_windows = uniform_unit(building) < 0.4 && is_outer(plan, wall);
    for (int slot = 0; (slot + 1) * kSlotM <= wall.length_m; ++slot) {
      brush.style = slot_style(world, floor, names, index, slot);
      brush.detail = detail(slot);
      brush.left_m = slot * kSlotM;
      furnish_slot(brush, in_hall, has_windows);
    }
    brush.left_m = 0;
    brush.fill(0, 0, wall.length_m, 0.08, colour(60, 62, 65));  // skirting
  }
  light_wall(plan, wall, picture);
  return make_wall_texture(picture);
}

// Light falls on floor and ceiling in the same pattern.
cv::Mat light_map(const FloorPlan& plan, const Monitor& monitor) {
  cv::Mat map(plan.rows * 2, plan.columns * 2, CV_32F, cv::Scalar(kAmbientLight));
  parallel_for(static_cast<size_t>(map.rows), monitor, [&](size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < map.cols; ++x) {
      const Point p{plan.origin.x + (x + 0.5) * kLightStepM,
                    plan.origin.y + (y + 0.5) * kLightStepM};
      if (plan.is_open(p)) map.at<float>(y, x) = static_cast<float>(light_at(plan, p));
    }
  });
  return map;
}

constexpr int kTile = static_cast<int>(0.6 * kPlanTexelsPerMetre);

void tile(cv::Mat& picture, RandomEngine& engine, const cv::Scalar& base, double spread,
          const cv::Scalar& joint) {
  for (int y = 0; y < picture.rows; y += kTile)
    for (int x = 0; x < picture.cols; x += kTile) {
      const double shade = 1 + between(engine, -spread, spread);
      cv::rectangle(picture, cv::Rect(x, y, kTile, kTile), base * shade, cv::FILLED);
      cv::rectangle(picture, cv::Rect(x, y, kTile, kTile), joint);
    }
}

void shade(cv::Mat& picture, const cv::Mat& light, double factor) {
  cv::Mat full;
  cv::resize(light, full, picture.size(), 0, 0, cv::INTER_LINEAR);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        uint8_t& value = picture.at<cv::Vec4b>(y, x)[c];
        value = cv::saturate_cast<uint8_t>(value * full.at<float>(y, x) * factor);
      }
}

cv::Mat plan_picture(const FloorPlan& plan) {
  const int cell = static_cast<int>(kPlanCellM * kPlanTexelsPerMetre);
  return cv::Mat(plan.rows * cell, plan.columns * cell, CV_8UC4, cv::Scalar(0));
}

Texture paint_floor(const World& world, const FloorNames& names, const FloorPlan& plan,
                    const cv::Mat& light) {
  RandomEngine engine = named_engine(world.seed, "ground/" + names.plan);
  cv::Mat picture = plan_picture(plan);
  const double tone = between(engine, 95, 150);
  const cv::Scalar base =
      colour(tone * between(engine, 0.8, 1), tone, tone * between(engine, 1, 1.12));
  tile(picture, engine, base, 0.06, base * 0.72);
  RandomEngine detail = named_engine(world.seed, "dirt/" + names.own);
  roughen(picture, detail, 9, 9);
  shade(picture, light, 0.95);
  return make_texture(picture);
}

Texture paint_ceiling(const World& world, const FloorNames& names, const FloorPlan& plan,
                      const cv::Mat& light) {
  RandomEngine engine = named_engine(world.seed, "ceiling/" + names.plan);
  cv::Mat picture = plan_picture(plan);
  tile(picture, engine, colour(196, 204, 206), 0.02, colour(130, 136, 138));
  RandomEngine detail = named_engine(world.seed, "ceiling-detail/" + names.own);
  roughen(picture, detail, 6, 4);
  for (int i = 0; i < plan.rows * plan.columns / 20; ++i)  // detectors and nozzles
    cv::circle(picture,
               {static_cast<int>(uniform_below(detail, static_cast<uint64_t>(picture.cols))),
                static_cast<int>(uniform_below(detail, static_cast<uint64_t>(picture.rows)))},
               4, colour(90, 92, 95), cv::FILLED);
  shade(picture, light, 0.72);
  for (const Point& lamp : plan.lamps) {
    if (uniform_unit(detail) < 0.06) continue;  // a broken one
    const auto x = static_cast<int>((lamp.x - plan.origin.x - 0.6) * kPlanTexelsPerMetre);
    const auto y = static_cast<int>((lamp.y - plan.origin.y - 0.3) * kPlanTexelsPerMetre);
    cv::rectangle(picture, cv::Rect(x, y, 2 * kTile, kTile), colour(255, 255, 255), cv::FILLED);
    for (int bar = kTile / 2; bar < 2 * kTile; bar += kTile / 2)
      cv::line(picture, {x + bar, y}, {x + bar, y + kTile}, colour(215, 220, 222));
  }
  return make_texture(picture);
}

}  // namespace

Scene make_scene(const World& world, size_t floor, const Monitor& monitor) {
  const Floor& planned = plan_floor(world, floor);
  const FloorNames names{world.floors[floor].name, planned.name};
  Scene scene;
  scene.plan = make_floor_plan(planned);
  const Finish finish = building_finish(world, names);
  scene.walls.resize(scene.plan.walls.size());
  parallel_for(scene.walls.size(), monitor, [&](size_t i) {
    scene.walls[i] = paint_wall(world, floor, names, finish, scene.plan, i);
  });
  const cv::Mat light = light_map(scene.plan, monitor);
  scene.floor = paint_floor(world, names, scene.plan, light);
  scene.ceiling = paint_ceiling(world, names, scene.plan, light);
  return scene;
}

}  // namespace vpr
