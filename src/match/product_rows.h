// Vectors of integers, padded for the kernels of scalar products, with their sizes: the common part
// of distances by scalar products.
#pragma once

#include <algorithm>
#include <cassert>
#include <memory>

#include <fmt/format.h>

#include "base/aligned_vector.h"
#include "base/error.h"
#include "describe/imported.h"
#include "match/cosine_kernels.h"
#include "match/frame_distances.h"

namespace vpr {

/// The values of a descriptor. T is their type, of 8 or 16 bits.
template <class T>
std::span<const T> numbers(DescriptorRow row) {
  return {reinterpret_cast<const T*>(row.data()), row.size() / sizeof(T)};
}

template <class T>
int64_t square_of(DescriptorRow row) {
  int64_t sum = 0;
  for (const T number : numbers<T>(row)) sum += int64_t{number} * number;
  return sum;
}

template <class T>
int64_t product_of(DescriptorRow a, DescriptorRow b) {
  int64_t product = 0;
  for (size_t i = 0; i < numbers<T>(a).size(); ++i)
    product += int64_t{numbers<T>(a)[i]} * numbers<T>(b)[i];
  return product;
}

inline size_t round_up(size_t value, size_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

/// The common data of distances to the same training frames. Vectors are padded for the kernels.
template <class T>
struct ProductTraining {
  std::vector<DescriptorSpan> sequences;
  ProductKernels<T> kernels;
  double (*size)(double square) = nullptr;  ///< the size of a vector for the kernels
  size_t length = 0;
  size_t padded_length = 0;
  AlignedVector<T> rows;  ///< aligned to a cache line
  std::vector<double> sizes;
};

/// A query with the sizes of its vectors.
struct SizedQuery {
  DescriptorRows rows;
  std::vector<double> sizes;
};

/// Throws Error(data) if the product of two vectors may exceed 32 bits, which our programs never
/// write.
template <class T>
void append_sizes(std::vector<double>& sizes, const DescriptorRows& rows,
                  double (*size)(double square)) {
  for (size_t i = 0; i < rows.size(); ++i) {
    const int64_t square = square_of<T>(rows[i]);
    if (sizeof(T) > 1 && square > kMaxSquaredLength)
      throw Error(ErrorKind::data, fmt::format("the vector of frame {} is longer than 46340", i));
    sizes.push_back(size(static_cast<double>(square)));
  }
}

template <class T>
void fill_product_tile(const ProductTraining<T>& training, const SizedQuery& query,
                       std::span<const uint32_t> queries, size_t first, size_t last, uint16_t* out,
                       size_t stride) {
  assert(first % kStretchFrames == 0);
  std::vector<int16_t> widened(queries.size() * training.padded_length, 0);
  std::vector<ProductQuery> vectors;
  for (const uint32_t frame : queries) {
    int16_t* vector = widened.data() + vectors.size() * training.padded_length;
    const std::span<const T> row = numbers<T>(query.rows[frame]);
    std::copy(row.begin(), row.end(), vector);
    vectors.push_back({vector, query.sizes[frame]});
  }
  const ProductRows<T> rows{training.rows.data() + first * training.padded_length,
                            training.sizes.data() + first, round_up(last - first, kCosineRows),
                            training.padded_length};
  training.kernels.tile(vectors, rows, out, stride);
}

/// Fills the members of a training. Throws Error(data) for vectors that are too long.
template <class T>
void start_training(ProductTraining<T>& training, std::span<const DescriptorSpan> train,
                    size_t length, const ProductKernels<T>& kernels,
                    double (*size)(double square)) {
  if (length > kMaxNumbers)
    throw Error(
        ErrorKind::data,
        fmt::format("vectors of {} values: the maximum for distances is {}", length, kMaxNumbers));
  training.sequences.assign(train.begin(), train.end());
  training.kernels = kernels;
  training.size = size;
  training.length = length;
  training.padded_length = round_up(length, kCosineNumbers);
  const size_t frames = round_up(count_frames(train), kCosineRows);
  training.rows.resize(frames * training.padded_length, 0);
  T* row = training.rows.data();
  for (const DescriptorSpan& sequence : train) {
    append_sizes<T>(training.sizes, sequence.rows, size);
    for (size_t i = 0; i < sequence.rows.size(); ++i, row += training.padded_length) {
      const std::span<const T> from = numbers<T>(sequence.rows[i]);
      std::copy(from.begin(), from.end(), row);
    }
  }
  training.sizes.resize(frames, 0);
}

/// A query's distances to these training frames, except row_total and of_query.
template <class T, class Training>
FrameDistances product_distances(const std::shared_ptr<Training>& training,
                                 const DescriptorSpan& of) {
  FrameDistances distances = frames_to_compare(training->sequences, of);
  const auto query = std::make_shared<SizedQuery>(SizedQuery{of.rows, {}});
  append_sizes<T>(query->sizes, of.rows, training->size);
  distances.tile = [training, query](std::span<const uint32_t> queries, size_t first, size_t last,
                                     uint16_t* out, size_t stride) {
    fill_product_tile<T>(*training, *query, queries, first, last, out, stride);
  };
  return distances;
}

}  // namespace vpr
