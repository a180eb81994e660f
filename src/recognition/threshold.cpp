#include "recognition/threshold.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "matching/score_kernels.h"

namespace vpr {
namespace {

// The smallest number that is no hit. `estimate` is off by a rounding at most.
template <class IsHit>
uint32_t smallest_without(double estimate, const IsHit& is_hit) {
  constexpr uint32_t kMost = std::numeric_limits<uint32_t>::max();
  if (estimate >= kMost) return kMost;
  auto limit = static_cast<uint32_t>(std::max(estimate, 0.0));
  while (limit > 0 && !is_hit(limit - 1)) --limit;
  while (limit < kMost && is_hit(limit)) ++limit;
  return limit;
}

}  // namespace

uint32_t distance_limit(double threshold, double divisor) {
  assert(std::isfinite(threshold));
  if (!(threshold > 0)) return 0;
  if (divisor == 0) return 1;
  return smallest_without(std::floor(threshold * divisor), [&](uint32_t distance) {
    return static_cast<double>(distance) / divisor < threshold;
  });
}

uint32_t score_limit(double threshold, size_t window_length) {
  assert(std::isfinite(threshold));
  const double estimate = std::floor(threshold * kScoreUnit * static_cast<double>(window_length)) +
                          static_cast<double>(score_offset(window_length));
  return smallest_without(
      estimate, [&](uint32_t biased_sum) { return mean_z(biased_sum, window_length) < threshold; });
}

int64_t score_offset(size_t window_length) {
  assert(window_length <= kMaxScoredWindow);
  return static_cast<int64_t>(window_length) * kScoreBias;
}

double mean_z(uint32_t biased_sum, size_t window_length) {
  return static_cast<double>(biased_sum - score_offset(window_length)) /
         (kScoreUnit * static_cast<double>(window_length));
}

}  // namespace vpr
