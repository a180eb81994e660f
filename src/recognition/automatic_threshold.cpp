#include "recognition/automatic_threshold.h"

#include <algorithm>
#include <cmath>

#include "matching/distance_statistics.h"

namespace vpr {
namespace {

// Of how much windows of c_l frames spread below the typical distance, and below the mean one of
// the query window: c_l independent distances would by 1 / sqrt(c_l). Measured on floors that look
// alike (docs/methods.md).
constexpr double kSpread = 0.65;
constexpr double kMeanSpread = 0.8;

// Scores of c_l independent frames would spread by 1 / sqrt(c_l) deviations.
constexpr double kScoreSpread = 5.5;

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
  return {std::min(found, most) * safety_factor, ThresholdScale::bits, !closest || most < found};
}

AutomaticThreshold own_threshold(const std::optional<ClosestWindows>& closest,
                                 double typical_distance, size_t window_length,
                                 double safety_factor) {
  const auto length = static_cast<double>(window_length);
  const double most = std::max(0.0, 1 - kMeanSpread / std::sqrt(length));
  const double found = closest && typical_distance > 0
                           ? static_cast<double>(closest->score) / length / typical_distance
                           : most;
  return {std::min(found, most) * safety_factor, ThresholdScale::mean, !closest || most < found};
}

double largest_score_threshold(size_t window_length) {
  return -kScoreSpread / std::sqrt(static_cast<double>(window_length));
}

AutomaticThreshold automatic_score_threshold(const std::optional<ClosestWindows>& closest,
                                             size_t window_length, double margin) {
  const double most = largest_score_threshold(window_length);
  const double found = closest ? mean_z(closest->score, window_length) : most;
  return {std::min(found, most) - margin, ThresholdScale::mean_z, !closest || most < found};
}

double typical_distance(const DescriptorSpan& sequence, const Monitor& monitor) {
  StatisticsSettings settings;
  settings.samples = kTypicalSamples;
  return compute_statistics({&sequence, 1}, settings, monitor).typical_distance;
}

}  // namespace vpr
