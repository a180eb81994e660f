// Quantiles and confidence intervals of measured values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/random.h"

namespace vpr {

/// The p-quantile, p in [0, 1], by linear interpolation between order statistics (type 7 of Hyndman
/// & Fan, NumPy's default). values must not be empty.
double quantile(std::vector<double> values, double p);

/// The middle value, or the mean of the two middle values. values must not be empty.
double median(std::vector<double> values);

/// part / whole as a double; unset if the whole is 0.
template <class Part, class Whole>
std::optional<double> share_of(Part part, Whole whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// A confidence interval, both ends included.
struct Interval {
  double low = 0;
  double high = 0;
};

/// How often each of `count` values is drawn in one resample of the circular block bootstrap
/// (Politis & Romano 1992): blocks of `block` consecutive values are drawn with replacement until
/// there are `count` values. block is at least 1.
std::vector<uint32_t> block_weights(size_t count, size_t block, RandomEngine& engine);

/// The central 95% interval of the sum of `values` in 2000 resamples of block_weights, for values
/// that depend on their neighbors, as frames do. The same seed yields the same interval. values
/// must not be empty; block is at least 1.
Interval bootstrap_sum(const std::vector<double>& values, size_t block, uint64_t seed);

}  // namespace vpr
