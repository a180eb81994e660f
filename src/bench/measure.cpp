#include "bench/measure.h"

#include <algorithm>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <sched.h>

#include "base/error.h"
#include "base/statistics.h"
#include "base/stopwatch.h"

namespace vpr {
namespace {

// A line "Name:   123 kB" of a file below /proc.
size_t proc_bytes(const char* path, const std::string& name) {
  std::ifstream file(path);
  for (std::string word; file >> word;) {
    if (word != name + ":") continue;
    size_t kilobytes = 0;
    file >> kilobytes;
    return kilobytes * 1024;
  }
  return 0;
}

}  // namespace

TimeSummary summarise(std::vector<double> times_ms) {
  std::sort(times_ms.begin(), times_ms.end());
  return {median(times_ms), quantile(times_ms, 0.25), quantile(times_ms, 0.75),
          times_ms.front(), times_ms.back(),          times_ms.size()};
}

void check_seconds(double seconds) {
  if (!(seconds > 0 && seconds <= 3600))
    throw Error(ErrorKind::usage,
                fmt::format("seconds must be above 0 and at most 3600, found {}", seconds));
}

std::vector<double> time_repeatedly(const Effort& effort, const std::function<void()>& work,
                                    const Monitor& monitor) {
  for (size_t i = 0; i < effort.warm_ups; ++i) {
    check_stop(monitor);
    work();
  }
  std::vector<double> times_ms;
  const Stopwatch all;
  while (times_ms.size() < effort.repetitions ||
         (all.elapsed_s() < effort.seconds && times_ms.size() < effort.most)) {
    check_stop(monitor);
    const Stopwatch watch;
    work();
    times_ms.push_back(watch.elapsed_ms());
  }
  return times_ms;
}

void pin_to_cores(size_t cores) {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof(allowed), &allowed) != 0) return;
  cpu_set_t chosen;
  CPU_ZERO(&chosen);
  size_t count = 0;
  for (int core = 0; core < CPU_SETSIZE && count < cores; ++core) {
    if (!CPU_ISSET(core, &allowed)) continue;
    CPU_SET(core, &chosen);
    ++count;
  }
  if (count == cores) sched_setaffinity(0, sizeof(chosen), &chosen);
}

void reset_peak_memory() { std::ofstream("/proc/self/clear_refs") << "5"; }

size_t peak_memory() { return proc_bytes("/proc/self/status", "VmHWM"); }

size_t available_memory() { return proc_bytes("/proc/meminfo", "MemAvailable"); }

}  // namespace vpr
