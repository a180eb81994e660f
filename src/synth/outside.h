// What is far away outside the windows: a panorama without parallax.
#pragma once

#include <vector>

#include "synth/floor_plan.h"
#include "synth/texture.h"

namespace vpr {

/// From this daylight share of a wall's texel on, what is outside shows through it.
inline constexpr int kGlassDaylight = 200;

/// Sky, houses, trees and ground around a building, in daylight: as a wall's texture, whose strips
/// go once around by azimuth and are as high as tangents of elevation from 1 to -1.
Texture make_panorama(uint64_t seed);

/// The strip of a panorama in a direction (any length > 0), for pixels `pixel_rad` wide.
void panorama_strip(const Texture& panorama, Point direction, double pixel_rad,
                    std::vector<cv::Vec4b>& strip);

}  // namespace vpr
