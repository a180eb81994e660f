// Memory for large arrays that are read in whole, once per query frame.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

#include <sys/mman.h>

namespace vpr {

/// An allocator for std::vector, aligned to cache lines. Large arrays are aligned to huge pages and
/// use them if the system has them: reading is faster because fewer addresses are translated, and
/// because prefetchers stop at the end of a page.
template <class T>
struct HugePageAllocator {
  using value_type = T;

  HugePageAllocator() = default;
  template <class Other>
  HugePageAllocator(const HugePageAllocator<Other>&) {}

  T* allocate(size_t count) {
    constexpr size_t kCacheLine = 64;
    constexpr size_t kHugePage = size_t{2} << 20;
    constexpr size_t kFewestPages = 4;  // rounding up costs at most a quarter of the memory
    const bool is_large = count >= kFewestPages * kHugePage / sizeof(T);
    const size_t alignment = is_large ? kHugePage : kCacheLine;
    if (count > (size_t{1} << 62) / sizeof(T)) throw std::bad_alloc();
    const size_t bytes = (count * sizeof(T) + alignment - 1) / alignment * alignment;
    void* memory = std::aligned_alloc(alignment, bytes);
    if (memory == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    if (is_large) madvise(memory, bytes, MADV_HUGEPAGE);  // advice: errors do not matter
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, size_t) { std::free(memory); }

  bool operator==(const HugePageAllocator&) const = default;
};

}  // namespace vpr
