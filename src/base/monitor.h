// How long work tells its caller how far it is, and how the caller stops it.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>

namespace vpr {

/// Every member may be empty. Callbacks are called from any thread, several at once.
struct Monitor {
  /// Step in words, units done, units in all (0: unknown).
  std::function<void(const std::string& step, size_t done, size_t total)> progress;
  /// One sentence for the user about something that is odd but no error.
  std::function<void(const std::string& sentence)> warn;
  /// Becomes true when the user wants to stop.
  const std::atomic<bool>* stop = nullptr;
};

/// Ends work that the user wants to stop: throws Error(interrupted) then.
void check_stop(const Monitor& monitor);

/// Passes a warning on, one whole sentence, to who listens; without a listener it is lost.
void warn(const Monitor& monitor, const std::string& sentence);

/// Counts units of one step that are finished in any thread and order.
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

/// For the work on the thing `index` (from 0) of `count`: what is reported as "match" arrives at
/// `monitor` as "match NAME 3/14" ("match NAME" if there is one thing only), and as a share of the
/// whole step, whose parts are taken to be of one size. Parts may have parts.
Monitor part_of(const Monitor& monitor, const std::string& name, size_t index, size_t count);

}  // namespace vpr
