#include "synth/daylight.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "synth/scene.h"

namespace vpr {
namespace {

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
    const double dx = point.x - source.at.x, dy = point.y - source.at.y;
    const double square = dx * dx + dy * dy;
    if (square > kReachM * kReachM) continue;
    const double toward = (dx * source.inward.x + dy * source.inward.y + kInFrontM) /
                          std::sqrt(square + kInFrontM * kInFrontM);
    if (toward > 0 && can_see(plan, point, source.at))
      light += source.strength * std::min(1.0, toward) / (1 + square);
  }
  return light;
}

bool is_outer(const FloorPlan& plan, const Wall& wall) {
  const Point way = wall_direction(wall.side);
  const Point out{-way.y, way.x};
  Point p{wall.start.x + way.x * wall.length_m / 2, wall.start.y + way.y * wall.length_m / 2};
  for (double meters = 0.25; meters < 500; meters += kPlanCellM)
    if (plan.is_open({p.x + out.x * meters, p.y + out.y * meters})) return false;
  return true;
}

double light_at(const FloorPlan& plan, Point point) {
  double light = kAmbientLight;
  for (const Lamp& lamp : plan.lamps) {
    const double dx = lamp.at.x - point.x, dy = lamp.at.y - point.y, square = dx * dx + dy * dy;
    if (square < kLampReachM * kLampReachM && can_see(plan, point, lamp.at))
      light += lamp.power * 1.5 / (1.6 + square);
  }
  return light;
}

uint8_t daylight_share(float daylight, float light) {
  return static_cast<uint8_t>(std::min<double>(kGlassDaylight - 1, 255 * daylight / light));
}

BakedLight bake_along(const FloorDay& floor_day, const Wall& wall, int texels) {
  const Point way = wall_direction(wall.side);
  const int steps = std::max(2, static_cast<int>(wall.length_m / kLightStepM));
  const bool daylit = !floor_day.daylight.empty();
  cv::Mat light(1, steps, CV_32F), daylight(1, steps, CV_32F, cv::Scalar(0));
  for (int i = 0; i < steps; ++i) {
    const double meters = (i + 0.5) * wall.length_m / steps;
    const double corner = std::min(meters, wall.length_m - meters);
    const Point p{wall.start.x + way.x * meters + way.y * 0.05,
                  wall.start.y + way.y * meters - way.x * 0.05};
    double all = light_at(floor_day.plan, p);
    if (daylit) {
      daylight.at<float>(0, i) =
          static_cast<float>(daylight_at(floor_day.plan, floor_day.daylight, p));
      all += daylight.at<float>(0, i);
    }
    light.at<float>(0, i) = static_cast<float>(all * (1 - 0.25 * std::exp(-corner / 0.3)));
  }
  cv::resize(light, light, {texels, 1}, 0, 0, cv::INTER_LINEAR);
  if (!daylit) return {light, {}};
  cv::resize(daylight, daylight, {texels, 1}, 0, 0, cv::INTER_LINEAR);
  return {light, daylight};
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

BakedLight light_map(const FloorDay& floor_day, const Monitor& monitor) {
  const FloorPlan& plan = floor_day.plan;
  cv::Mat map(plan.rows * 2, plan.columns * 2, CV_32F, cv::Scalar(kAmbientLight));
  cv::Mat daylight(map.size(), CV_32F, cv::Scalar(0));
  parallel_for(static_cast<size_t>(map.rows), monitor, [&](size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < map.cols; ++x) {
      const Point p{plan.origin.x + (x + 0.5) * kLightStepM,
                    plan.origin.y + (y + 0.5) * kLightStepM};
      if (!plan.is_open(p)) continue;
      const double day = daylight_at(plan, floor_day.daylight, p);
      daylight.at<float>(y, x) = static_cast<float>(day);
      map.at<float>(y, x) = static_cast<float>(light_at(plan, p) + day);
    }
  });
  return {map, floor_day.daylight.empty() ? cv::Mat() : daylight};
}

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

}  // namespace vpr
