// The inner loop of distances by scalar products, compiled once for every SIMD target and chosen at
// run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vpr {

/// Vectors are padded with zeros to a multiple of so many numbers, and training vectors to a
/// multiple of so many rows.
inline constexpr size_t kCosineNumbers = 32;
inline constexpr size_t kCosineRows = 8;

/// A query vector, padded, and its size: the length for cosines, its square for points.
struct ProductQuery {
  const int16_t* numbers = nullptr;
  double size = 0;
};

/// Training vectors, padded, one after the other, and their sizes.
template <class T>
struct ProductRows {
  const T* numbers = nullptr;
  const double* sizes = nullptr;
  size_t count = 0;   ///< a multiple of kCosineRows
  size_t length = 0;  ///< of a padded vector
};

/// Kernels for training vectors of 8- or of 16-bit numbers. All targets give the same integers.
template <class T>
struct ProductKernels {
  /// out[t * stride + i] = the distance of queries[t] to row i. Scalar products, and any part of
  /// their sums, must stay below 2^31: vectors of up to 131071 numbers of 8 bits do, and those of
  /// 16 bits whose squared length is 46340^2 at most.
  void (*tile)(std::span<const ProductQuery> queries, const ProductRows<T>& rows, uint16_t* out,
               size_t stride);
};

/// The kernels of cosine distances of the SIMD target in use (base/simd.h).
template <class T>
ProductKernels<T> select_cosine_kernels();
template <>
ProductKernels<int8_t> select_cosine_kernels();
template <>
ProductKernels<int16_t> select_cosine_kernels();
/// Those of Euclidean distances: the root of the squared one, to the nearest, a half up, 65535 at
/// most.
ProductKernels<int16_t> select_point_kernels();

}  // namespace vpr
