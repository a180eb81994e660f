// The parallel loop of the toolkit (oneTBB). Results must not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "base/monitor.h"

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

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

/// Says, in builds with ThreadSanitizer, that all that this thread did so far comes before what
/// another does after take_over with the same address. In other builds it does nothing.
inline void hand_over([[maybe_unused]] const void* address) {
#if defined(__SANITIZE_THREAD__)
  __tsan_release(const_cast<void*>(address));
#endif
}

/// The other end of hand_over.
inline void take_over([[maybe_unused]] const void* address) {
#if defined(__SANITIZE_THREAD__)
  __tsan_acquire(const_cast<void*>(address));
#endif
}

// Of all parallel loops: an address of each loop's own would have to be read before it is taken
// over.
inline constexpr char kLoopBegin = 0;
inline constexpr char kLoopEnd = 0;

/// The order of a parallel loop: all parts come after its beginning and before its end, and in no
/// order among themselves.
struct ThreadOrder {
  ThreadOrder() { hand_over(&kLoopBegin); }
  ~ThreadOrder() { take_over(&kLoopEnd); }
  ThreadOrder(const ThreadOrder&) = delete;
  ThreadOrder& operator=(const ThreadOrder&) = delete;

  /// Lives while a part is worked on.
  struct Part {
    Part() { take_over(&kLoopBegin); }
    ~Part() { hand_over(&kLoopEnd); }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;
  };
};

}  // namespace vpr
