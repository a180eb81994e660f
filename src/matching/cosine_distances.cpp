#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <mutex>

#include <fmt/format.h>

#include "base/error.h"
#include "descriptors/imported.h"
#include "matching/cosine_kernels.h"
#include "matching/frame_distances.h"

namespace vpr {
namespace {

constexpr double kLargest = 65535;  // of opposite directions

// T is the type of a vector's numbers, of 8 or of 16 bits.
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
double norm_of(DescriptorRow row) {
  return std::sqrt(static_cast<double>(square_of<T>(row)));
}

// As the kernels do it.
uint32_t rounded(int64_t product, double norms) {
  const double cosine = norms > 0 ? static_cast<double>(product) / norms : 0;
  const double distance = (1 - cosine) * (kLargest / 2);
  return static_cast<uint32_t>(std::clamp(distance + 0.5, 0.0, kLargest));
}

size_t round_up(size_t value, size_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

/// What distances of any query to the same training frames share. Vectors are padded as the kernels
/// take them.
template <class T>
struct Training {
  std::vector<DescriptorSpan> sequences;
  std::vector<DescriptorSpan> centred_over;
  CosineKernels<T> kernels;
  size_t length = 0;
  size_t padded_length = 0;
  std::vector<T> rows;
  std::vector<double> norms;
  std::once_flag has_sum;
  std::vector<double> unit_sum;  ///< of centred_over, made when it is first asked for
};

/// A query and the lengths of its vectors.
struct Query {
  DescriptorRows rows;
  std::vector<double> norms;
};

// Throws where the product of two such vectors might not fit 32 bits: no program of ours wrote
// them.
template <class T>
void append_norms(std::vector<double>& norms, const DescriptorRows& rows) {
  for (size_t i = 0; i < rows.size(); ++i) {
    const int64_t square = square_of<T>(rows[i]);
    if (sizeof(T) > 1 && square > kMostWideSquare)
      throw Error(ErrorKind::data, fmt::format("the vector of frame {} is longer than 46340", i));
    norms.push_back(std::sqrt(static_cast<double>(square)));
  }
}

// The vectors of all readable frames, each of length 1, added in their order.
template <class T>
std::vector<double> sum_of_units(std::span<const DescriptorSpan> sequences, size_t length) {
  std::vector<double> sum(length, 0);
  for (const DescriptorSpan& sequence : sequences) {
    for (const FrameRun& run : readable_runs(sequence)) {
      for (size_t i = run.first; i < run.first + run.count; ++i) {
        const DescriptorRow row = sequence.rows[i];
        const double norm = norm_of<T>(row);
        for (size_t x = 0; norm > 0 && x < length; ++x) sum[x] += numbers<T>(row)[x] / norm;
      }
    }
  }
  return sum;
}

template <class T>
void fill_tile(const Training<T>& training, const Query& query, std::span<const uint32_t> queries,
               size_t first, size_t last, uint16_t* out, size_t stride) {
  assert(first % kStretchFrames == 0);
  std::vector<int16_t> widened(queries.size() * training.padded_length, 0);
  std::vector<CosineQuery> vectors;
  for (const uint32_t frame : queries) {
    int16_t* vector = widened.data() + vectors.size() * training.padded_length;
    const std::span<const T> row = numbers<T>(query.rows[frame]);
    std::copy(row.begin(), row.end(), vector);
    vectors.push_back({vector, query.norms[frame]});
  }
  const CosineRows<T> rows{training.rows.data() + first * training.padded_length,
                           training.norms.data() + first, round_up(last - first, kCosineRows),
                           training.padded_length};
  training.kernels.tile(vectors, rows, out, stride);
}

template <class T>
uint64_t row_total(Training<T>& training, const Query& query, size_t frames, size_t frame) {
  std::call_once(training.has_sum, [&] {
    training.unit_sum = sum_of_units<T>(training.centred_over, training.length);
  });
  const std::span<const T> vector = numbers<T>(query.rows[frame]);
  double sum = 0;
  for (size_t x = 0; x < training.length; ++x) sum += vector[x] * training.unit_sum[x];
  const double cosines = query.norms[frame] > 0 ? sum / query.norms[frame] : 0;
  return static_cast<uint64_t>(
      std::max((static_cast<double>(frames) - cosines) * (kLargest / 2) + 0.5, 0.0));
}

template <class T>
FrameDistances distances_of(const std::shared_ptr<Training<T>>& training,
                            const DescriptorSpan& of) {
  FrameDistances distances = frames_to_compare(training->sequences, of, training->centred_over);
  const auto query = std::make_shared<Query>(Query{of.rows, {}});
  append_norms<T>(query->norms, of.rows);
  distances.tile = [training, query](std::span<const uint32_t> queries, size_t first, size_t last,
                                     uint16_t* out, size_t stride) {
    fill_tile(*training, *query, queries, first, last, out, stride);
  };
  distances.row_total = [training, query, frames = distances.centred_frames](size_t frame) {
    return row_total(*training, *query, frames, frame);
  };
  distances.of_query = [training](const DescriptorSpan& other) {
    return distances_of(training, other);
  };
  return distances;
}

template <class T>
FrameDistances make_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query,
                              std::span<const DescriptorSpan> centred_over) {
  const size_t length = query.rows.shape.length;
  if (length > kMostNumbers)
    throw Error(ErrorKind::data, fmt::format("vectors of {} numbers: cosine distances take {} at "
                                             "most",
                                             length, kMostNumbers));
  const auto training = std::make_shared<Training<T>>();
  training->sequences.assign(train.begin(), train.end());
  training->centred_over.assign(centred_over.begin(), centred_over.end());
  training->kernels = select_cosine_kernels<T>();
  training->length = length;
  training->padded_length = round_up(length, kCosineNumbers);
  const size_t frames = round_up(count_frames(train), kCosineRows);
  training->rows.resize(frames * training->padded_length, 0);
  T* row = training->rows.data();
  for (const DescriptorSpan& sequence : train) {
    append_norms<T>(training->norms, sequence.rows);
    for (size_t i = 0; i < sequence.rows.size(); ++i, row += training->padded_length) {
      const std::span<const T> from = numbers<T>(sequence.rows[i]);
      std::copy(from.begin(), from.end(), row);
    }
  }
  training->norms.resize(frames, 0);
  return distances_of(training, query);
}

template <class T>
uint32_t pair_distance(DescriptorRow a, DescriptorRow b) {
  const std::span<const T> from = numbers<T>(a);
  const std::span<const T> to = numbers<T>(b);
  int64_t product = 0;
  for (size_t i = 0; i < from.size(); ++i) product += int64_t{from[i]} * to[i];
  return rounded(product, norm_of<T>(a) * norm_of<T>(b));
}

template <class T>
Projector make_projector(const DescriptorRows& to, std::span<const ComponentValues> weights) {
  struct Sums {
    ComponentValues of_weights = {};
    std::vector<ComponentValues> of_units;  ///< of vectors of length 1, times their weights
  };
  const auto sums = std::make_shared<Sums>();
  sums->of_units.resize(to.shape.length);
  for (size_t i = 0; i < to.size(); ++i) {
    const double norm = norm_of<T>(to[i]);
    for (size_t k = 0; k < kMostComponents; ++k) {
      sums->of_weights[k] += weights[i][k];
      for (size_t x = 0; norm > 0 && x < to.shape.length; ++x)
        sums->of_units[x][k] += weights[i][k] * (numbers<T>(to[i])[x] / norm);
    }
  }
  return [sums](DescriptorRow row) {
    const std::span<const T> vector = numbers<T>(row);
    ComponentValues values = {};
    for (size_t x = 0; x < vector.size(); ++x)
      for (size_t k = 0; k < kMostComponents; ++k) values[k] += vector[x] * sums->of_units[x][k];
    const double norm = norm_of<T>(row);
    for (size_t k = 0; k < kMostComponents; ++k)
      values[k] = (sums->of_weights[k] - (norm > 0 ? values[k] / norm : 0)) * (kLargest / 2);
    return values;
  };
}

}  // namespace

uint16_t largest_cosine(const DescriptorShape&) { return static_cast<uint16_t>(kLargest); }

uint32_t cosine_distance(DescriptorRow a, DescriptorRow b) { return pair_distance<int8_t>(a, b); }
uint32_t wide_cosine_distance(DescriptorRow a, DescriptorRow b) {
  return pair_distance<int16_t>(a, b);
}

Projector cosine_projector(const DescriptorRows& to, std::span<const ComponentValues> weights) {
  return make_projector<int8_t>(to, weights);
}
Projector wide_cosine_projector(const DescriptorRows& to,
                                std::span<const ComponentValues> weights) {
  return make_projector<int16_t>(to, weights);
}

FrameDistances cosine_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query,
                                std::span<const DescriptorSpan> centred_over) {
  return make_distances<int8_t>(train, query, centred_over);
}
FrameDistances wide_cosine_distances(std::span<const DescriptorSpan> train,
                                     const DescriptorSpan& query,
                                     std::span<const DescriptorSpan> centred_over) {
  return make_distances<int16_t>(train, query, centred_over);
}

}  // namespace vpr
