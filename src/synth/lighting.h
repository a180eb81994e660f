// How bright a picture is: lamps, daylight and the camera's automatic exposure.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "synth/camera.h"
#include "synth/world.h"

namespace vpr {

/// Factors of 256 by which lamp-lit and daylit texels are multiplied: blue, green, red.
struct Light {
  std::array<int, 3> lamps{};
  std::array<int, 3> day{};
};

/// The light of a canvas whose columns are cast, under automatic exposure that aims at a mean grey
/// value. `drift` is a factor of that exposure.
Light make_light(const Canvas& canvas, const std::vector<Column>& columns,
                 const Conditions& conditions, double drift);

/// Turns a texel (blue, green, red, daylight share of 255) into the grey values of a pixel.
inline void shine(const std::array<int, 4>& texel, const Light& light, std::array<int, 3>& out) {
  for (size_t c = 0; c < 3; ++c) {
    const int factor = light.lamps[c] + ((light.day[c] - light.lamps[c]) * texel[3] >> 8);
    out[c] = std::min(255, texel[c] * factor >> 8);
  }
}

}  // namespace vpr
