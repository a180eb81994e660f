#include <algorithm>
#include <cmath>
#include <mutex>

#include "match/product_rows.h"

namespace vpr {
namespace {

constexpr double kLargest = 65535;  // of opposite directions

double norm_of_square(double square) { return std::sqrt(square); }

template <class T>
double norm_of(DescriptorRow row) {
  return norm_of_square(static_cast<double>(square_of<T>(row)));
}

// Rounds like the kernels.
uint32_t rounded(int64_t product, double norms) {
  const double cosine = norms > 0 ? static_cast<double>(product) / norms : 0;
  const double distance = (1 - cosine) * (kLargest / 2);
  return static_cast<uint32_t>(std::clamp(distance + 0.5, 0.0, kLargest));
}

template <class T>
struct Training : ProductTraining<T> {
  std::once_flag has_sum;
  std::vector<double> unit_sum;  ///< over all readable frames; computed on first use
};

// The sum of the vectors of all readable frames, scaled to length 1, in their order.
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
uint64_t row_total(Training<T>& training, DescriptorRow row, size_t frames) {
  std::call_once(training.has_sum,
                 [&] { training.unit_sum = sum_of_units<T>(training.sequences, training.length); });
  const std::span<const T> vector = numbers<T>(row);
  const double norm = norm_of<T>(row);
  double sum = 0;
  for (size_t x = 0; x < training.length; ++x) sum += vector[x] * training.unit_sum[x];
  const double cosines = norm > 0 ? sum / norm : 0;
  return static_cast<uint64_t>(
      std::max((static_cast<double>(frames) - cosines) * (kLargest / 2) + 0.5, 0.0));
}

template <class T>
FrameDistances distances_of(const std::shared_ptr<Training<T>>& training,
                            const DescriptorSpan& of) {
  FrameDistances distances = product_distances<T>(training, of);
  distances.row_total = [training, rows = of.rows, frames = distances.readable_frames](
                            size_t frame) { return row_total(*training, rows[frame], frames); };
  distances.of_query = [training](const DescriptorSpan& other) {
    return distances_of(training, other);
  };
  return distances;
}

template <class T>
FrameDistances make_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query) {
  const auto training = std::make_shared<Training<T>>();
  start_training<T>(*training, train, query.rows.shape.length, select_cosine_kernels<T>(),
                    norm_of_square);
  return distances_of(training, query);
}

template <class T>
uint32_t pair_distance(DescriptorRow a, DescriptorRow b) {
  return rounded(product_of<T>(a, b), norm_of<T>(a) * norm_of<T>(b));
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
    for (size_t k = 0; k < kMaxComponents; ++k) {
      sums->of_weights[k] += weights[i][k];
      for (size_t x = 0; norm > 0 && x < to.shape.length; ++x)
        sums->of_units[x][k] += weights[i][k] * (numbers<T>(to[i])[x] / norm);
    }
  }
  return [sums](DescriptorRow row) {
    const std::span<const T> vector = numbers<T>(row);
    ComponentValues values = {};
    for (size_t x = 0; x < vector.size(); ++x)
      for (size_t k = 0; k < kMaxComponents; ++k) values[k] += vector[x] * sums->of_units[x][k];
    const double norm = norm_of<T>(row);
    for (size_t k = 0; k < kMaxComponents; ++k)
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

FrameDistances cosine_distances(std::span<const DescriptorSpan> train,
                                const DescriptorSpan& query) {
  return make_distances<int8_t>(train, query);
}
FrameDistances wide_cosine_distances(std::span<const DescriptorSpan> train,
                                     const DescriptorSpan& query) {
  return make_distances<int16_t>(train, query);
}

}  // namespace vpr
