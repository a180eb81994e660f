// Light that lamps and windows throw on walls, floors and ceilings, painted into them.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/monitor.h"
#include "synth/daylight.h"
#include "synth/finish.h"

namespace vpr {

/// What is painted: a floor on a day.
struct Setting {
  const World& world;
  size_t floor;
  const Floor& planned;  ///< the floor that has the plan
  const FloorNames& names;
  const FloorPlan& plan;
  const std::vector<Finish>& rooms;
  std::vector<DaylightSource> daylight;
  uint64_t day;
};

/// What shines on the texels of a surface, and how much of it is daylight.
struct Baked {
  cv::Mat light;     ///< CV_32F
  cv::Mat daylight;  ///< CV_32F, empty where no daylight falls in
};

/// Paints lamps and daylight into a wall's picture, darker corners, and less light near the floor.
/// Windows shine by themselves.
void light_wall(const Setting& setting, const Wall& wall, cv::Mat& picture);

/// The light of a floor's plan, in steps of a quarter of a metre.
Baked light_map(const Setting& setting, const Monitor& monitor);

/// Paints light into the picture of a floor or ceiling, `factor` of what falls on it.
void shade(cv::Mat& picture, const Baked& baked, double factor);

}  // namespace vpr
