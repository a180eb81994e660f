#include "evaluate/intervals.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace vpr {

Estimate estimate_share(uint64_t correct, uint64_t frames) {
  assert(frames > 0 && correct <= frames);
  constexpr double kZ = 1.959964;  // the 97.5 % quantile of the normal distribution
  const auto n = static_cast<double>(frames);
  const double rate = static_cast<double>(correct) / n;
  const double middle = rate + kZ * kZ / (2 * n);
  const double half = kZ * std::sqrt(rate * (1 - rate) / n + kZ * kZ / (4 * n * n));
  const double scale = 1 + kZ * kZ / n;
  return {frames,
          rate,
          {std::max(0.0, (middle - half) / scale), std::min(1.0, (middle + half) / scale)}};
}

}  // namespace vpr
