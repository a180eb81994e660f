// Light baked into surfaces: lamps, and daylight through glass fronts and windows.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/monitor.h"
#include "synth/surfaces.h"

namespace vpr {

/// One meter of glass, seen from the room.
struct DaylightSource {
  Point at;
  Point inward;  ///< unit vector
  double strength = 1;
};

/// Whether a wall has windows: some of the walls that face the outside do.
bool has_windows(const World& world, const FloorNames& names, const FloorPlan& plan, size_t wall);

/// All glass of a floor, scaled by variety.window_light; empty if that is 0.
std::vector<DaylightSource> daylight_sources(const World& world, const FloorNames& names,
                                             const FloorPlan& plan);

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

/// Applies lamps and daylight to the image of a wall, with darker corners and less light near the
/// floor. Windows are light sources themselves.
void light_wall(const FloorDay& floor_day, const Wall& wall, cv::Mat& picture);

/// The light on a floor plan, with a resolution of a quarter of a meter.
BakedLight light_map(const FloorDay& floor_day, const Monitor& monitor);

/// Applies light, scaled by `factor`, to the image of a floor or ceiling.
void shade(cv::Mat& picture, const BakedLight& baked, double factor);

}  // namespace vpr
