// The inner loop of distances of images, compiled once per SIMD target and selected at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vpr {

/// Images are padded with zeros to a multiple of this number of pixels.
inline constexpr size_t kGrayPixels = 64;

/// All targets give the same integers.
struct GrayKernels {
  /// out[t * row_count + i] = the sum of absolute differences of queries[t] and row i, for
  /// consecutive rows of `length` (padded) pixels.
  void (*tile)(std::span<const uint8_t* const> queries, const uint8_t* rows, size_t row_count,
               size_t length, uint32_t* out);
};

/// The kernel for the current SIMD target (base/simd.h).
GrayKernels select_gray_kernels();

}  // namespace vpr
