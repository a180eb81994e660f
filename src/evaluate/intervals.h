// Confidence intervals of shares, and the dependence of neighboring frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

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

/// The block length of a circular block bootstrap of the mean of a series whose neighbors depend on
/// each other (Politis and White 2004, with the correction of Patton, Politis and White 2009): from
/// the autocorrelations up to the lag after which they are not significant. At least 1, at most
/// min(3 sqrt(n), n / 3) rounded up; 1 for a constant series.
double block_length(std::span<const double> series);

}  // namespace vpr
