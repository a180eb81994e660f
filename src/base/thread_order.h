// What ThreadSanitizer can't see for itself, because distributions' oneTBB is not built with it.
#pragma once

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace vpr {

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
