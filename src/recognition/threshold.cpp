#include "recognition/threshold.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace vpr {

uint32_t distance_limit(double threshold, uint32_t divisor) {
  assert(std::isfinite(threshold));
  if (!(threshold > 0)) return 0;
  if (divisor == 0) return 1;
  constexpr uint32_t kMost = std::numeric_limits<uint32_t>::max();
  const double estimate = std::floor(threshold * divisor);
  if (estimate >= kMost) return kMost;
  const auto is_hit = [&](uint32_t distance) {
    return static_cast<double>(distance) / divisor < threshold;
  };
  auto limit = static_cast<uint32_t>(estimate);  // off by a rounding at most
  while (limit > 0 && !is_hit(limit - 1)) --limit;
  while (limit < kMost && is_hit(limit)) ++limit;
  return limit;
}

}  // namespace vpr
