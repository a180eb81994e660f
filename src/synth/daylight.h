// Daylight that falls into rooms through glass fronts and windows.
#pragma once

#include <vector>

#include "synth/finish.h"

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

/// How much daylight falls on a point, where 1 is what lamps give.
double daylight_at(const FloorPlan& plan, const std::vector<DaylightSource>& sources, Point point);

}  // namespace vpr
