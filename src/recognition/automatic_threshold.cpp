#include "recognition/automatic_threshold.h"

#include <algorithm>
#include <cmath>

#include "matching/distance_statistics.h"

namespace vpr {
namespace {

// How far the closest windows of c_l frames are below the typical distance. Independent distances
// would be by 1 / sqrt(c_l). Measured on floors that look alike (docs/methods.md).
constexpr double kSpread = 0.65;

constexpr uint64_t kTypicalSamples = 1000;

}  // namespace

double largest_threshold(double typical_distance, size_t window_length) {
  return (1 - kSpread / std::sqrt(static_cast<double>(window_length))) * typical_distance;
}

AutomaticThreshold automatic_threshold(const std::optional<ClosestWindows>& closest,
                                       double typical_distance, size_t window_length,
                                       double safety_factor) {
  const double most = largest_threshold(typical_distance, window_length);
  const double found =
      closest ? static_cast<double>(closest->score) / static_cast<double>(window_length) : most;
  return {std::min(found, most) * safety_factor, !closest || most < found};
}

double typical_distance(const DescriptorSpan& sequence, const Monitor& monitor) {
  StatisticsSettings settings;
  settings.samples = kTypicalSamples;
  return compute_statistics({&sequence, 1}, settings, monitor).typical_distance;
}

}  // namespace vpr
