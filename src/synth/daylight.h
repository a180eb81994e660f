// Light that is painted into surfaces: of lamps, and daylight that falls into rooms through glass
// fronts and windows.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/monitor.h"
#include "synth/surfaces.h"

namespace vpr {

/// A metre of glass, seen from the room.
struct DaylightSource {
  Point at;
  Point inward;  ///< of length 1
  double strength = 1;
};

/// Whether windows are put into a wall: into some of those with nothing but the outside behind.
bool has_windows(const World& world, const FloorNames& names, const FloorPlan& plan, size_t wall);

/// All glass of a floor, by variety.window_light; nothing with that at 0.
std::vector<DaylightSource> daylight_sources(const World& world, const FloorNames& names,
                                             const FloorPlan& plan);

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
