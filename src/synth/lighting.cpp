#include "synth/lighting.h"

#include <cmath>

namespace vpr {
namespace {

constexpr double kMeanBrightness = 112;  // what the automatic exposure aims at
constexpr double kDaylightBrightness = 1.5;

double brightness(const Texel& texel, const Conditions& conditions) {
  const double day = texel[3] / 255.0;
  return (texel[0] + texel[1] + texel[2]) / 3.0 *
         (day * conditions.daylight * kDaylightBrightness + (1 - day) * conditions.lamps);
}

}  // namespace

double metered_brightness(const Canvas& canvas, const std::vector<const Column*>& columns,
                          const Conditions& conditions) {
  constexpr double kFloorAndCeiling = 110;
  double sum = 0;
  for (const Column* column : columns) {
    double wall = 0;
    for (const Texel& texel : column->strip) wall += std::min(255.0, brightness(texel, conditions));
    wall /= static_cast<double>(column->strip.size());
    const double share = std::min(1.0, kRoomHeightM * canvas.focal / column->depth / canvas.rows());
    sum += share * wall + (1 - share) * kFloorAndCeiling * conditions.lamps;
  }
  return sum / static_cast<double>(columns.size());
}

Light make_light(double brightness, const Conditions& conditions, double drift) {
  const double gain =
      std::clamp(std::pow(kMeanBrightness / std::max(brightness, 1.0), 0.8), 0.3, 3.0) *
      conditions.exposure * drift * 256;
  const std::array<double, 3> balance = {1 - 0.14 * conditions.warmth, 1.0,
                                         1 + 0.14 * conditions.warmth};
  const std::array<double, 3> sky = {1.06, 1.0, 0.96};
  Light light;
  for (size_t c = 0; c < 3; ++c) {
    const double limit = 30000;
    light.lamps[c] =
        static_cast<int>(std::lround(std::min(limit, gain * conditions.lamps * balance[c])));
    light.day[c] = static_cast<int>(std::lround(
        std::min(limit, gain * conditions.daylight * kDaylightBrightness * balance[c] * sky[c])));
  }
  return light;
}

}  // namespace vpr
