// Timing of the drivers.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

/// The median time of work(i) for i = 0, 1, ..., at least five times and for `seconds`.
inline double median_ms(double seconds, const std::function<void(int)>& work) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  const auto start = Clock::now();
  for (int i = 0; i < 5 || Clock::now() - start < std::chrono::duration<double>(seconds); ++i) {
    const auto before = Clock::now();
    work(i);
    times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - before).count());
  }
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  return times[times.size() / 2];
}
