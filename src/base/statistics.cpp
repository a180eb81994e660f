#include "base/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/random.h"

namespace vpr {

double quantile(std::vector<double> values, double p) {
  assert(!values.empty() && p >= 0 && p <= 1);
  std::sort(values.begin(), values.end());
  const double position = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<size_t>(std::floor(position));
  const size_t above = std::min(below + 1, values.size() - 1);
  const double fraction = position - static_cast<double>(below);
  if (fraction == 0) return values[below];
  return values[below] + fraction * (values[above] - values[below]);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

Interval bootstrap_sum(const std::vector<double>& values, size_t block, uint64_t seed) {
  constexpr size_t kResamples = 2000;
  const size_t n = values.size();
  RandomEngine engine(seed);
  std::vector<double> sums;
  for (size_t resample = 0; resample < kResamples; ++resample) {
    double sum = 0;
    for (size_t drawn = 0; drawn < n; drawn += block) {
      const size_t start = uniform_below(engine, n);
      for (size_t i = 0; i < std::min(block, n - drawn); ++i) sum += values[(start + i) % n];
    }
    sums.push_back(sum);
  }
  return {quantile(sums, 0.025), quantile(sums, 0.975)};
}

}  // namespace vpr
