// Distances by scalar products: cosine and Euclidean.
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>

#include "base/error.h"
#include "database/imported.h"
#include "match/frame_distances.h"
#include "match/huge_pages.h"
#include "match/product_kernels.h"

namespace vpr {
namespace {

constexpr double kLargest = 65535;  // the cosine distance of opposite directions

// The values of a descriptor, of 8 or 16 bits.
template <class T>
std::span<const T> values_of(DescriptorRow row) {
  return {reinterpret_cast<const T*>(row.data()), row.size() / sizeof(T)};
}

// The product fits 32 bits (kMaxSquaredLength). Unsigned partial sums are vectorized by the
// compiler and may wrap, which signed ones must not.
template <class T>
int64_t product_of(DescriptorRow a, DescriptorRow b) {
  const std::span<const T> one = values_of<T>(a);
  const std::span<const T> other = values_of<T>(b);
  uint32_t product = 0;
  for (size_t i = 0; i < one.size(); ++i)
    product += static_cast<uint32_t>(int32_t{one[i]} * other[i]);
  return static_cast<int32_t>(product);
}

// The squared length, also of an invalid vector.
template <class T>
int64_t square_of(DescriptorRow row) {
  int64_t square = 0;
  for (const T value : values_of<T>(row)) square += int32_t{value} * value;
  return square;
}

template <class T>
double norm_of(DescriptorRow row) {
  return std::sqrt(static_cast<double>(product_of<T>(row, row)));
}

/// The size of a vector for the kernels, from its squared length.
using SizeOf = double (*)(double square);
double norm_of_square(double square) { return std::sqrt(square); }
double square_itself(double square) { return square; }

// Throws Error(data) if the product of two vectors may exceed 32 bits, which our programs never
// write.
template <class T>
void append_sizes(std::vector<double>& sizes, const DescriptorRows& rows, SizeOf size) {
  for (size_t i = 0; i < rows.size(); ++i) {
    const int64_t square = square_of<T>(rows[i]);
    if (sizeof(T) > 1 && square > kMaxSquaredLength)
      throw Error(ErrorKind::data, "the vector of frame {} is longer than 46340", i);
    sizes.push_back(size(static_cast<double>(square)));
  }
}

/// Training frames in the format of the kernels.
template <class T>
struct Training {
  ProductKernel<T> kernel = nullptr;
  SizeOf size = nullptr;
  size_t padded_length = 0;
  std::vector<T, HugePageAllocator<T>> rows;  ///< padded
  std::vector<double> sizes;
};

template <class T>
void fill_tile(const Training<T>& training, const DescriptorRows& query,
               const std::vector<double>& sizes, std::span<const uint32_t> queries, size_t first,
               size_t last, uint16_t* out, size_t stride) {
  assert(first % kBlockFrames == 0);
  std::vector<int16_t> widened(queries.size() * training.padded_length, 0);
  std::vector<ProductQuery> vectors;
  for (const uint32_t frame : queries) {
    int16_t* vector = widened.data() + vectors.size() * training.padded_length;
    std::ranges::copy(values_of<T>(query[frame]), vector);
    vectors.push_back({vector, sizes[frame]});
  }
  training.kernel(
      vectors,
      {training.rows.data() + first * training.padded_length, training.sizes.data() + first,
       round_up(last - first, kProductRows), training.padded_length},
      out, stride);
}

template <class T>
PreparedTraining prepare(std::span<const DescribedFrames> train, const DescriptorShape& shape,
                         ProductKernel<T> kernel, SizeOf size) {
  if (shape.length > kMaxIntegers)
    throw Error(ErrorKind::data, "vectors of {} values: the maximum for distances is {}",
                shape.length, kMaxIntegers);
  const auto training = std::make_shared<Training<T>>();
  training->kernel = kernel;
  training->size = size;
  training->padded_length = round_up(shape.length, kProductValues);
  const size_t frames = round_up(count_frames(train), kProductRows);
  training->rows.resize(frames * training->padded_length, 0);
  T* row = training->rows.data();
  for (const DescribedFrames& sequence : train) {
    append_sizes<T>(training->sizes, sequence.rows, size);
    for (size_t i = 0; i < sequence.rows.size(); ++i, row += training->padded_length)
      std::ranges::copy(values_of<T>(sequence.rows[i]), row);
  }
  training->sizes.resize(frames, 0);
  return [training](FrameDistances& distances) {
    const auto sizes = std::make_shared<std::vector<double>>();
    append_sizes<T>(*sizes, distances.query.rows, training->size);
    distances.tile = [training, rows = distances.query.rows, sizes](
                         std::span<const uint32_t> queries, size_t first, size_t last,
                         uint16_t* out, size_t stride) {
      fill_tile(*training, rows, *sizes, queries, first, last, out, stride);
    };
  };
}

/// Weighted sums of cosine distances to added vectors, for N sets of weights.
template <class T, size_t N>
class WeightedCosines {
 public:
  using Values = std::array<double, N>;

  explicit WeightedCosines(size_t length) : directions_(length, Values{}) {}

  void add(DescriptorRow row, const Values& weights) {
    const std::span<const T> vector = values_of<T>(row);
    const double norm = norm_of<T>(row);
    for (size_t k = 0; k < N; ++k) {
      weights_[k] += weights[k];
      for (size_t x = 0; norm > 0 && x < vector.size(); ++x)
        directions_[x][k] += weights[k] * (vector[x] / norm);
    }
  }

  // In units of 2/65535, not rounded.
  Values distances(DescriptorRow row) const {
    const std::span<const T> vector = values_of<T>(row);
    Values sums = {};
    for (size_t x = 0; x < vector.size(); ++x)
      for (size_t k = 0; k < N; ++k) sums[k] += vector[x] * directions_[x][k];
    const double norm = norm_of<T>(row);
    for (size_t k = 0; k < N; ++k)
      sums[k] = (weights_[k] - (norm > 0 ? sums[k] / norm : 0)) * (kLargest / 2);
    return sums;
  }

 private:
  Values weights_ = {};
  std::vector<Values> directions_;  // weighted sums of vectors scaled to length 1
};

template <class T>
PreparedTraining prepare_cosines(std::span<const DescribedFrames> train,
                                 const DescriptorShape& shape) {
  struct Totals {
    std::once_flag has_sums;
    std::optional<WeightedCosines<T, 1>> sums;  ///< over all readable frames; made on first use
  };
  return [totals = std::make_shared<Totals>(), sequences = std::vector(train.begin(), train.end()),
          set_tile = prepare<T>(train, shape, select_cosine_kernel<T>(), norm_of_square)](
             FrameDistances& distances) {
    set_tile(distances);
    distances.row_total = [totals, sequences, rows = distances.query.rows](size_t query) {
      std::call_once(totals->has_sums, [&] {
        totals->sums.emplace(rows.shape.length);
        for (const FrameStretch& run : readable_runs(sequences))
          for (size_t i = 0; i < run.count; ++i)
            totals->sums->add(sequences[run.sequence].rows[run.first_in_sequence + i], {1});
      });
      return static_cast<uint64_t>(std::max(totals->sums->distances(rows[query])[0] + 0.5, 0.0));
    };
  };
}

// Rounds like the kernels.
template <class T>
uint32_t cosine_distance(DescriptorRow a, DescriptorRow b) {
  const double norms = norm_of<T>(a) * norm_of<T>(b);
  const double cosine = norms > 0 ? static_cast<double>(product_of<T>(a, b)) / norms : 0;
  return static_cast<uint32_t>(std::clamp((1 - cosine) * (kLargest / 2) + 0.5, 0.0, kLargest));
}

template <class T>
Projector cosine_projector(const DescriptorRows& to, std::span<const ComponentValues> weights) {
  WeightedCosines<T, kMaxComponents> sums(to.shape.length);
  for (size_t i = 0; i < to.size(); ++i) sums.add(to[i], weights[i]);
  return [sums = std::move(sums)](DescriptorRow row) { return sums.distances(row); };
}

template <class T>
constexpr DistanceKind cosine_kind(ElementType element) {
  return {element,
          {"units of cosine distance", 2 / kLargest},
          [](const DescriptorShape&) { return static_cast<uint16_t>(kLargest); },
          cosine_distance<T>,
          cosine_projector<T>,
          prepare_cosines<T>};
}

using Coordinate = int16_t;

double exact_point_distance(DescriptorRow a, DescriptorRow b) {
  return std::sqrt(static_cast<double>(product_of<Coordinate>(a, a) + product_of<Coordinate>(b, b) -
                                       2 * product_of<Coordinate>(a, b)));
}

Projector point_projector(const DescriptorRows& to, std::span<const ComponentValues> weights) {
  return
      [shape = to.shape, bytes = std::vector<uint8_t>(to.bytes.begin(), to.bytes.end()),
       weights = std::vector<ComponentValues>(weights.begin(), weights.end())](DescriptorRow row) {
        ComponentValues values = {};
        for (size_t i = 0; i < weights.size(); ++i) {
          const double distance = exact_point_distance(DescriptorRows(shape, bytes)[i], row);
          for (size_t k = 0; k < kMaxComponents; ++k) values[k] += weights[i][k] * distance;
        }
        return values;
      };
}

}  // namespace

const DistanceKind kCosineDistance = cosine_kind<int8_t>(ElementType::int8);
const DistanceKind kWideCosineDistance = cosine_kind<int16_t>(ElementType::int16);

const DistanceKind kPointDistance = {
    ElementType::points16,
    {"units of coordinates", 1},
    [](const DescriptorShape&) -> uint16_t { return 2 * kLongestPoint; },
    [](DescriptorRow a, DescriptorRow b) {
      return static_cast<uint32_t>(std::lround(exact_point_distance(a, b)));
    },
    point_projector,
    [](std::span<const DescribedFrames> train, const DescriptorShape& shape) {
      return prepare<Coordinate>(train, shape, select_point_kernel(), square_itself);
    }};

}  // namespace vpr
