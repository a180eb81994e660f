// The inner loop of distances of pictures, compiled once for every SIMD target and chosen at run
// time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vpr {

/// Pictures are padded with zeros to a multiple of so many pixels.
inline constexpr size_t kGreyPixels = 64;

/// All targets give the same integers.
struct GreyKernels {
  /// out[t * row_count + i] = the sum of absolute differences of queries[t] and row i, of rows of
  /// `length` pixels (padded), one after the other.
  void (*tile)(std::span<const uint8_t* const> queries, const uint8_t* rows, size_t row_count,
               size_t length, uint32_t* out);
};

/// The kernel of the SIMD target in use (base/simd.h).
GreyKernels select_grey_kernels();

}  // namespace vpr
