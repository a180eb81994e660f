// The inner loops over rows of distances, compiled once per SIMD target and selected at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace vpr {

/// All targets give the same integers. Called per row or tile, never per pair.
struct RowKernels {
  std::string_view target;  ///< Highway's name: "AVX3_DL", "AVX2", "SSE4", ...

  /// after[x] = before[x] + entering[x] - leaving[x]: FastABLE's recurrence (paper, section VII).
  /// `before` and `after` are the same array or do not overlap.
  void (*slide)(const uint32_t* before, const uint16_t* entering, const uint16_t* leaving,
                uint32_t* after, size_t count);
  /// sums[x] += entering[x].
  void (*accumulate)(uint32_t* sums, const uint16_t* entering, size_t count);
  /// The smallest and the largest value; count > 0.
  uint32_t (*minimum)(const uint32_t* values, size_t count);
  uint32_t (*maximum)(const uint32_t* values, size_t count);
  /// The first index from `begin` on whose value is below `limit` (strict), or count.
  size_t (*find_below)(const uint32_t* values, size_t begin, size_t count, uint32_t limit);
};

/// The kernels for the current SIMD target (base/simd.h).
RowKernels select_kernels();

}  // namespace vpr
