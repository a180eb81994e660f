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

double block_length(std::span<const double> series) {
  const size_t count = series.size();
  if (count < 4) return 1;
  const auto n = static_cast<double>(count);
  double mean = 0;
  for (const double value : series) mean += value / n;
  const auto covariance = [&](size_t lag) {
    double sum = 0;
    for (size_t i = lag; i < count; ++i) sum += (series[i] - mean) * (series[i - lag] - mean);
    return sum / n;
  };
  const double variance = covariance(0);
  if (variance < 1e-12) return 1;
  // The smallest lag m that a run of insignificant autocorrelations follows.
  const double significant = 2 * std::sqrt(std::log10(n) / n);
  const auto run = static_cast<size_t>(std::max(5.0, std::ceil(std::sqrt(std::log10(n)))));
  const size_t most = std::min(count - 1, static_cast<size_t>(std::ceil(std::sqrt(n))) + run);
  size_t m = 0;  // the last significant lag before the run
  for (size_t lag = 1; lag <= most && lag <= m + run; ++lag)
    if (std::abs(covariance(lag)) > significant * variance) m = lag;
  const size_t bandwidth = std::min(2 * std::max<size_t>(m, 1), most);
  double g = 0;
  double spectrum = variance;
  for (size_t lag = 1; lag <= bandwidth; ++lag) {
    const double at = static_cast<double>(lag) / static_cast<double>(bandwidth);
    const double weight = at <= 0.5 ? 1 : 2 * (1 - at);  // a trapezoid
    const double both = 2 * weight * covariance(lag);    // lags of both signs
    g += both * static_cast<double>(lag);
    spectrum += both;
  }
  const double d = 4.0 / 3 * spectrum * spectrum;
  const double block = d > 0 ? std::cbrt(2 * g * g / d * n) : 1;
  return std::clamp(block, 1.0, std::ceil(std::min(3 * std::sqrt(n), n / 3)));
}

}  // namespace vpr
