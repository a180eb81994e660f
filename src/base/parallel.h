// The parallel loop of the toolkit (oneTBB). Results must not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "base/monitor.h"

namespace vpr {

/// Calls body(i) once for every i in [0, count), in any order, from several threads.
/// Throws what a body throws (any one of them), and Error(interrupted) on a stop.
void parallel_for(size_t count, const Monitor& monitor, const std::function<void(size_t)>& body);

/// Threads that parallel_for would use now.
size_t thread_count();

/// Limits the whole process to `threads` threads (0: all cores) while it lives.
class ThreadLimit {
 public:
  explicit ThreadLimit(size_t threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

}  // namespace vpr
