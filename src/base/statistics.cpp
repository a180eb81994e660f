#include "base/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

namespace vpr {

double quantile(std::vector<double> values, double p) {
  assert(!values.empty() && p >= 0 && p <= 1);
  std::ranges::sort(values);
  const double position = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<size_t>(std::floor(position));
  const size_t above = std::min(below + 1, values.size() - 1);
  const double fraction = position - static_cast<double>(below);
  if (fraction == 0) return values[below];
  return values[below] + fraction * (values[above] - values[below]);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

std::vector<uint32_t> block_weights(size_t count, size_t block, RandomEngine& engine) {
  std::vector<uint32_t> weights(count, 0);
  for (size_t drawn = 0; drawn < count; drawn += block) {
    const size_t start = uniform_below(engine, count);
    for (size_t i = 0; i < std::min(block, count - drawn); ++i) ++weights[(start + i) % count];
  }
  return weights;
}

Interval bootstrap_sum(const std::vector<double>& values, size_t block, uint64_t seed) {
  constexpr size_t kResamples = 2000;
  RandomEngine engine(seed);
  std::vector<double> sums;
  for (size_t resample = 0; resample < kResamples; ++resample) {
    const std::vector<uint32_t> weights = block_weights(values.size(), block, engine);
    sums.push_back(std::inner_product(values.begin(), values.end(), weights.begin(), 0.0));
  }
  return {quantile(sums, 0.025), quantile(sums, 0.975)};
}

}  // namespace vpr
