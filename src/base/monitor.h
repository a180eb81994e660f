// Progress reports, warnings and cancellation of long-running work.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace vpr {

/// Every member may be empty. Callbacks are called from any thread, possibly concurrently.
struct Monitor {
  /// The name of the step, units done, and units in total (0: unknown).
  std::function<void(const std::string& step, size_t done, size_t total)> progress;
  /// A warning for the user, one sentence.
  std::function<void(const std::string& sentence)> warn;
  /// Becomes true when the user wants to stop.
  const std::atomic<bool>* stop = nullptr;
};

/// Throws Error(interrupted) if the user wants to stop.
void check_stop(const Monitor& monitor);

/// Forwards a warning, one sentence; without a callback it is dropped.
void warn(const Monitor& monitor, const std::string& sentence);
template <class First, class... Rest>
void warn(const Monitor& monitor, fmt::format_string<First, Rest...> sentence, First&& first,
          Rest&&... rest) {
  warn(monitor, fmt::format(sentence, std::forward<First>(first), std::forward<Rest>(rest)...));
}

/// The monitor, but it forwards each warning once. `monitor` must outlive it.
Monitor with_each_warning_once(const Monitor& monitor);

/// Counts the finished units of one step, from any thread and in any order.
class StepCounter {
 public:
  StepCounter(const Monitor& monitor, std::string step, size_t total);
  /// Throws Error(interrupted) once the user wants to stop.
  void add(size_t units = 1);

 private:
  const Monitor& monitor_;
  std::string step_;
  size_t total_;
  std::atomic<size_t> done_{0};
};

/// A monitor for part `index` (from 0) of `count` parts. It reports the step "match" as "match NAME
/// 3/14" ("match NAME" if there is only one part), with its progress as a fraction of the whole
/// step; all parts count the same. Parts may be nested.
Monitor part_of(const Monitor& monitor, const std::string& name, size_t index, size_t count);

}  // namespace vpr
