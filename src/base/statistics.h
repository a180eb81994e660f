// Order statistics of measured values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/random.h"

namespace vpr {

/// The p-quantile, p in [0, 1], linear between order statistics (Hyndman & Fan's type 7, NumPy's
/// default). values must not be empty.
double quantile(std::vector<double> values, double p);

/// The middle value, or the mean of the two middle values. values must not be empty.
double median(std::vector<double> values);

/// A confidence interval, both ends included.
struct Interval {
  double low = 0;
  double high = 0;
};

/// How often each of `count` values is drawn in one resample of the circular block bootstrap
/// (Politis & Romano 1992): stretches of `block` values that follow each other are drawn with
/// replacement until there are `count`. block is at least 1.
std::vector<uint32_t> block_weights(size_t count, size_t block, RandomEngine& engine);

/// The central 95 % of the sum of `values` in 2000 resamples of block_weights. For values that
/// depend on their neighbours, as frames do. The same seed gives the same interval. values must not
/// be empty; block is at least 1.
Interval bootstrap_sum(const std::vector<double>& values, size_t block, uint64_t seed);

/// The exact 95 % interval of the mean of a Poisson distribution of which `count` was drawn
/// (Garwood 1936): below its low end, so many or more are drawn with 2.5 %, above its high end so
/// many or fewer. Where none was drawn, all 5 % are above the high end, which is 3.0 then (the rule
/// of three).
Interval poisson_interval(uint64_t count);

}  // namespace vpr
