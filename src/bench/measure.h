// Repeated timing on the steady clock, and what is said of it.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "base/monitor.h"

namespace vpr {

/// Repeated measurements of one time, in milliseconds.
struct TimeSummary {
  double median_ms = 0;
  double lower_quartile_ms = 0;
  double upper_quartile_ms = 0;
  double least_ms = 0;
  double most_ms = 0;
  size_t repetitions = 0;
};

/// Order statistics (base/statistics.h) of times in milliseconds, of which there is at least one.
TimeSummary summarise(std::vector<double> times_ms);

/// How long to measure.
struct Effort {
  double seconds = 0.5;    ///< goes on at least so long, ...
  size_t repetitions = 5;  ///< ... and at least so often, ...
  size_t most = 10'000;    ///< ... but not more often
  size_t warm_ups = 1;     ///< runs before, which do not count
};

/// Throws Error(usage) unless a measurement may take so long: above 0, at most an hour.
void check_seconds(double seconds);

/// Milliseconds of each run of `work`. Stops between runs when asked to.
std::vector<double> time_repeatedly(const Effort& effort, const std::function<void()>& work,
                                    const Monitor& monitor);

/// Keeps the process, and threads that it starts from now on, on the first `cores` of its cores, so
/// that the scheduler moves nothing; without effect where it has fewer.
void pin_to_cores(size_t cores);

/// Resets the process's highest resident memory, where the system can (Linux).
void reset_peak_memory();
/// Bytes at most in memory since; 0 where it is not known.
size_t peak_memory();
/// Bytes that the system could still give; 0 where it is not known.
size_t available_memory();

}  // namespace vpr
