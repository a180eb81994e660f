// The inner loop of distances by scalar products, compiled once per SIMD target and selected at run
// time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vpr {

/// Vectors are padded with zeros to a multiple of kProductValues values, and training vectors to a
/// multiple of kProductRows rows.
inline constexpr size_t kProductValues = 32;
inline constexpr size_t kProductRows = 8;

/// A padded query vector and its size: the length for cosines, the squared length for points.
struct ProductQuery {
  const int16_t* values = nullptr;
  double size = 0;
};

/// Padded training vectors, one after the other, and their sizes.
template <class T>
struct ProductRows {
  const T* values = nullptr;
  const double* sizes = nullptr;
  size_t count = 0;   ///< a multiple of kProductRows
  size_t length = 0;  ///< of a padded vector
};

/// out[t * stride + i] = the distance of queries[t] to row i. Scalar products and their partial
/// sums must stay below 2^31: vectors of up to 131071 8-bit values satisfy this, and vectors of
/// 16-bit values with a squared length of at most 46340^2. All targets give the same integers.
template <class T>
using ProductKernel = void (*)(std::span<const ProductQuery> queries, const ProductRows<T>& rows,
                               uint16_t* out, size_t stride);

/// The kernel of cosine distances for the current SIMD target (base/simd.h).
template <class T>
ProductKernel<T> select_cosine_kernel();
template <>
ProductKernel<int8_t> select_cosine_kernel();
template <>
ProductKernel<int16_t> select_cosine_kernel();
/// The kernel of Euclidean distances: rounded to nearest, ties up, at most 65535.
ProductKernel<int16_t> select_point_kernel();

}  // namespace vpr
