#include "match/components.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "match/zscores.h"

namespace vpr {
namespace {

constexpr size_t kIterations = 8;
constexpr double kCaution = 15;  // relative eigenvalue of a component that is subtracted by half
constexpr double kWeightUnit = 1 << 20;  // weights are multiples of 1 / kWeightUnit: sums are exact
constexpr int kMostLoading = 127;
constexpr int kMostComponentWeight = 4095;  // the sum of all these products fits 16 bits
constexpr double kUnitsPerBit = 8;
constexpr double kProductShift = 128;  // loading x weight / kProductShift is in units
// relative to the sum of eigenvalues: smaller components do not exist
constexpr double kLeastNorm = 1e-9;
constexpr size_t kPart = 4096;  // training frames per task

using Vectors = std::vector<ComponentValues>;  // one entry per landmark

double rounded(double value) { return std::floor(value + 0.5); }

// The keyframes of every run of readable frames.
std::vector<size_t> choose_landmarks(std::span<const DescribedFrames> train,
                                     double typical_distance) {
  std::vector<size_t> frames;
  for (const FrameStretch& run : readable_runs(train)) {
    KeyframeQueue views = make_keyframe_queue(typical_distance);
    for (size_t i = 0; i < run.count; ++i) {
      const size_t frame = run.first_in_sequence + i;
      if (!is_new_keyframe(views, train[run.sequence].rows, frame)) continue;
      push_keyframe(views, frame);
      frames.push_back(run.first + i);
    }
  }
  const size_t count = std::min(frames.size(), kMostLandmarks);
  std::vector<size_t> landmarks;
  for (size_t l = 0; l < count; ++l) landmarks.push_back(frames[l * frames.size() / count]);
  return landmarks;
}

std::vector<DescriptorRow> all_rows(std::span<const DescribedFrames> train) {
  std::vector<DescriptorRow> rows;
  for (const DescribedFrames& sequence : train)
    for (size_t i = 0; i < sequence.rows.size(); ++i) rows.push_back(sequence.rows[i]);
  return rows;
}

/// The landmarks' similarities, row by row: -1/2 times their distances, minus row and column means,
/// plus the mean of all. `trace` is the sum of the eigenvalues.
struct Similarities {
  size_t size = 0;
  std::vector<double> values;
  double trace = 0;
};

Similarities centered_similarities(const DescriptorRows& rows) {
  const size_t n = rows.size();
  Similarities similarities{n, std::vector<double>(n * n), 0};
  std::vector<double> means(n, 0);
  const auto pair = distance_of(rows.shape.element).pair;
  parallel_for(n, {}, [&](size_t a) {
    for (size_t b = 0; b < n; ++b) {
      const double distance = pair(rows[a], rows[b]);
      similarities.values[a * n + b] = distance;
      means[a] += distance;
    }
    means[a] /= static_cast<double>(n);
  });
  const double mean = std::accumulate(means.begin(), means.end(), 0.0) /
                      static_cast<double>(std::max<size_t>(n, 1));
  for (size_t a = 0; a < n; ++a) {
    for (size_t b = 0; b < n; ++b) {
      double& value = similarities.values[a * n + b];
      value = -(value - means[a] - means[b] + mean) / 2;
    }
    similarities.trace += similarities.values[a * n + a];
  }
  return similarities;
}

Vectors multiply(const Similarities& matrix, const Vectors& vectors) {
  Vectors products(matrix.size);
  parallel_for(matrix.size, {}, [&](size_t a) {
    ComponentValues sum = {};
    const double* row = matrix.values.data() + a * matrix.size;
    for (size_t b = 0; b < matrix.size; ++b)
      for (size_t k = 0; k < kMaxComponents; ++k) sum[k] += row[b] * vectors[b][k];
    products[a] = sum;
  });
  return products;
}

double product(const Vectors& vectors, size_t j, size_t k) {
  double sum = 0;
  for (const ComponentValues& values : vectors) sum += values[j] * values[k];
  return sum;
}

// Gram-Schmidt. A vector with almost nothing left becomes 0.
void make_orthonormal(Vectors& vectors, double least_norm) {
  for (size_t k = 0; k < kMaxComponents; ++k) {
    for (size_t j = 0; j < k; ++j) {
      const double shared = product(vectors, j, k);
      for (ComponentValues& values : vectors) values[k] -= shared * values[j];
    }
    const double norm = std::sqrt(product(vectors, k, k));
    for (ComponentValues& values : vectors) values[k] = norm > least_norm ? values[k] / norm : 0;
  }
}

Vectors leading_vectors(const Similarities& matrix) {
  RandomEngine engine(1);
  Vectors vectors(matrix.size);
  for (ComponentValues& values : vectors)
    for (double& value : values) value = uniform_unit(engine) - 0.5;
  make_orthonormal(vectors, 0);
  for (size_t i = 0; i < kIterations; ++i) {
    vectors = multiply(matrix, vectors);
    make_orthonormal(vectors, kLeastNorm * matrix.trace);
  }
  return vectors;
}

/// The values that determine loadings and factors: one entry per component.
struct Scales {
  ComponentValues mean = {};        ///< of the landmarks' components
  ComponentValues eigenvalue = {};  ///< 0: the component does not exist
  ComponentValues largest = {};     ///< largest loading of a landmark
};

double loading(const Scales& scales, size_t k, double component) {
  return scales.eigenvalue[k] > 0 ? -(component - scales.mean[k]) / (2 * scales.eigenvalue[k]) : 0;
}

Scales scales_of(const TrainComponents& components, const Similarities& matrix,
                 const Projector& project) {
  Scales scales;
  const Vectors products = multiply(matrix, components.weights);
  Vectors of_landmarks;
  for (size_t l = 0; l < matrix.size; ++l) of_landmarks.push_back(project(components.rows()[l]));
  for (size_t k = 0; k < kMaxComponents; ++k) {
    scales.eigenvalue[k] = std::sqrt(product(products, k, k));
    for (const ComponentValues& values : of_landmarks) scales.mean[k] += values[k];
    scales.mean[k] /= static_cast<double>(matrix.size);
    for (const ComponentValues& values : of_landmarks)
      scales.largest[k] = std::max(scales.largest[k], std::abs(loading(scales, k, values[k])));
  }
  return scales;
}

void set_loadings(TrainComponents& components, const Scales& scales, const Projector& project,
                  const std::vector<DescriptorRow>& rows, const Monitor& monitor) {
  parallel_for(divide_up(rows.size(), kPart), monitor, [&](size_t part) {
    const size_t last = std::min(rows.size(), (part + 1) * kPart);
    for (size_t i = part * kPart; i < last; ++i) {
      const ComponentValues values = project(rows[i]);
      for (size_t k = 0; k < kMaxComponents; ++k) {
        if (!(scales.largest[k] > 0)) continue;
        const double share = loading(scales, k, values[k]) / scales.largest[k];
        components.loadings[k][i] =
            static_cast<int8_t>(rounded(kMostLoading * std::clamp(share, -1.0, 1.0)));
      }
    }
  });
}

}  // namespace

TrainComponents no_components(size_t train_frames) {
  TrainComponents components;
  for (std::vector<int8_t>& loadings : components.loadings) loadings.assign(train_frames, 0);
  return components;
}

TrainComponents compute_components(std::span<const DescribedFrames> train, double typical_distance,
                                   const Monitor& monitor) {
  const std::vector<DescriptorRow> rows = all_rows(train);
  TrainComponents components = no_components(rows.size());
  components.landmarks = choose_landmarks(train, typical_distance);
  if (components.landmarks.empty()) return components;
  components.shape = train.front().rows.shape;
  for (const size_t frame : components.landmarks)
    components.bytes.insert(components.bytes.end(), rows[frame].begin(), rows[frame].end());
  const Similarities matrix = centered_similarities(components.rows());
  components.weights = leading_vectors(matrix);
  for (ComponentValues& values : components.weights)
    for (double& value : values) value = rounded(value * kWeightUnit) / kWeightUnit;
  if (!(matrix.trace > 0)) return components;
  const Projector project = make_projector(components);
  const Scales scales = scales_of(components, matrix, project);
  const double chance = kCaution * matrix.trace / static_cast<double>(matrix.size);
  for (size_t k = 0; k < kMaxComponents; ++k) {
    const double share = scales.eigenvalue[k] / (scales.eigenvalue[k] + chance);
    components.factor[k] =
        share * scales.largest[k] / kMostLoading * kProductShift / component_unit(components.shape);
  }
  set_loadings(components, scales, project, rows, monitor);
  return components;
}

Projector make_projector(const TrainComponents& components) {
  return distance_of(components.shape.element).projector(components.rows(), components.weights);
}

ComponentWeights component_weights(const TrainComponents& components,
                                   const ComponentValues& of_frame) {
  ComponentWeights weights = {};
  for (size_t k = 0; k < kMaxComponents; ++k)
    weights[k] = static_cast<int16_t>(std::clamp<double>(
        rounded(of_frame[k] * components.factor[k]), -kMostComponentWeight, kMostComponentWeight));
  return weights;
}

int component_sum(const TrainComponents& components, const ComponentWeights& weights,
                  size_t train_frame) {
  int sum = 0;
  for (size_t k = 0; k < kMaxComponents; ++k)
    sum += component_product(components.loadings[k][train_frame], weights[k]);
  return sum;
}

double component_unit(const DescriptorShape& shape) {
  return reference_bit(largest_distance(shape)) / kUnitsPerBit;
}

}  // namespace vpr
