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

inline constexpr int kMeteredColumns = 16;  ///< every so manieth column of a picture is metered

/// How bright a canvas is, in grey values before exposure, by some of its columns.
double metered_brightness(const Canvas& canvas, const std::vector<const Column*>& columns,
                          const Conditions& conditions);

/// The light under automatic exposure that was metered to `brightness`, and aims at a mean grey
/// value. `drift` is a factor of that exposure.
Light make_light(double brightness, const Conditions& conditions, double drift);

/// Turns a texel (blue, green, red, daylight share of 255) into the grey values of a pixel.
inline void shine(const std::array<int, 4>& texel, const Light& light, std::array<int, 3>& out) {
  for (size_t c = 0; c < 3; ++c) {
    const int factor = light.lamps[c] + ((light.day[c] - light.lamps[c]) * texel[3] >> 8);
    out[c] = std::min(255, texel[c] * factor >> 8);
  }
}

}  // namespace vpr
