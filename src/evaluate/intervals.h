// Confidence intervals of shares, and the dependence of neighboring frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/statistics.h"

namespace vpr {

/// A share that was estimated from a sample of frames.
struct Estimate {
  uint64_t frames = 0;  ///< of the sample
  double rate = 0;
  Interval interval;  ///< 95 %
};

/// correct / frames with its interval (Wilson 1927, z = 1.96). frames must not be 0.
Estimate estimate_share(uint64_t correct, uint64_t frames);

}  // namespace vpr
