// The inner loop of cosine distances, compiled once for every SIMD target and chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vpr {

/// All targets give the same integers.
struct CosineKernels {
  /// out[t * row_count + i] = the scalar product of queries[t] and row i, for rows of `length`
  /// numbers, one after the other. Sums stay below 2^31 for a length of 131071 at most.
  void (*tile)(std::span<const int8_t* const> queries, const int8_t* rows, size_t row_count,
               size_t length, int32_t* out);
};

/// The kernel of the SIMD target in use (base/simd.h).
CosineKernels select_cosine_kernels();

}  // namespace vpr
