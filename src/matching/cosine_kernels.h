// The inner loop of cosine distances, compiled once for every SIMD target and chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vpr {

/// Vectors are padded with zeros to a multiple of so many numbers, and training vectors to a
/// multiple of so many rows.
inline constexpr size_t kCosineNumbers = 32;
inline constexpr size_t kCosineRows = 8;

/// A query vector, padded, and its length.
struct CosineQuery {
  const int16_t* numbers = nullptr;
  double norm = 0;
};

/// Training vectors, padded, one after the other, and their lengths.
template <class T>
struct CosineRows {
  const T* numbers = nullptr;
  const double* norms = nullptr;
  size_t count = 0;   ///< a multiple of kCosineRows
  size_t length = 0;  ///< of a padded vector
};

/// Kernels for training vectors of 8- or of 16-bit numbers. All targets give the same integers.
template <class T>
struct CosineKernels {
  /// out[t * stride + i] = the cosine distance of queries[t] to row i. Scalar products, and any
  /// part of their sums, must stay below 2^31: vectors of up to 131071 numbers of 8 bits do, and
  /// those of 16 bits whose squared length is 46340^2 at most.
  void (*tile)(std::span<const CosineQuery> queries, const CosineRows<T>& rows, uint16_t* out,
               size_t stride);
};

/// The kernels of the SIMD target in use (base/simd.h).
template <class T>
CosineKernels<T> select_cosine_kernels();
template <>
CosineKernels<int8_t> select_cosine_kernels();
template <>
CosineKernels<int16_t> select_cosine_kernels();

}  // namespace vpr
