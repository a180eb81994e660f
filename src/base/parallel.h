// The toolkit's parallel loop (oneTBB). Results must not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "base/monitor.h"

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace vpr {

/// Calls body(i) once for every i in [0, count), in any order, from several threads. Rethrows one
/// exception of a body; throws Error(interrupted) on a stop.
void parallel_for(size_t count, const Monitor& monitor, const std::function<void(size_t)>& body);

/// The number of threads that parallel_for uses at present.
size_t thread_count();

/// Limits the whole process to `threads` threads (0: all cores) during its lifetime.
class ThreadLimit {
 public:
  explicit ThreadLimit(size_t threads);

 private:
  std::shared_ptr<void> control_;
};

/// Tells ThreadSanitizer that everything this thread has done so far happens before what another
/// thread does after take_over with the same address. Does nothing in other builds.
inline void hand_over([[maybe_unused]] const void* address) {
#if defined(__SANITIZE_THREAD__)
  __tsan_release(const_cast<void*>(address));
#endif
}

/// The counterpart of hand_over.
inline void take_over([[maybe_unused]] const void* address) {
#if defined(__SANITIZE_THREAD__)
  __tsan_acquire(const_cast<void*>(address));
#endif
}

// Shared by all parallel loops: reading an address of the loop's own would itself be a race before
// take_over.
inline constexpr char kLoopBegin = 0;
inline constexpr char kLoopEnd = 0;

/// The order within a parallel loop: all parts come after its beginning and before its end, and are
/// unordered among each other.
struct ThreadOrder {
  ThreadOrder() { hand_over(&kLoopBegin); }
  ~ThreadOrder() { take_over(&kLoopEnd); }
  ThreadOrder(const ThreadOrder&) = delete;
  ThreadOrder& operator=(const ThreadOrder&) = delete;

  /// Lives as long as the work on one part.
  struct Part {
    Part() { take_over(&kLoopBegin); }
    ~Part() { hand_over(&kLoopEnd); }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;
  };
};

}  // namespace vpr
