#include "reference/reference.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "match/frame_distances.h"
#include "match/score_kernels.h"

namespace vpr {

namespace {

std::vector<int64_t> bytes_of(DescriptorRow row) {
  std::vector<int64_t> values;
  for (const uint8_t byte : row) values.push_back(byte < 128 ? byte : byte - 256);
  return values;
}

std::vector<int64_t> byte_pairs_of(DescriptorRow row) {
  std::vector<int64_t> values;
  for (size_t i = 0; i < row.size(); i += 2) {
    const int64_t value = row[i] + 256 * int64_t{row[i + 1]};
    values.push_back(value < 32768 ? value : value - 65536);
  }
  return values;
}

double cosine_distance(const std::vector<int64_t>& a, const std::vector<int64_t>& b) {
  const auto product = [](const std::vector<int64_t>& x, const std::vector<int64_t>& y) {
    return static_cast<double>(std::inner_product(x.begin(), x.end(), y.begin(), int64_t{0}));
  };
  const double lengths = std::sqrt(product(a, a)) * std::sqrt(product(b, b));
  return (1 - (lengths > 0 ? product(a, b) / lengths : 0)) * 65535 / 2;
}

double point_distance(const std::vector<int64_t>& a, const std::vector<int64_t>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += static_cast<double>((a[i] - b[i]) * (a[i] - b[i]));
  return std::sqrt(sum);
}

double gray_distance(DescriptorRow a, DescriptorRow b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return 256 * sum / static_cast<double>(a.size());
}

bool contains(std::span<const size_t> frames, size_t frame) {
  return std::binary_search(frames.begin(), frames.end(), frame);
}

double mean_over(std::span<const DescribedFrames> sequences, const DescriptorRows& query,
                 size_t frame) {
  double sum = 0;
  size_t count = 0;
  for (const DescribedFrames& sequence : sequences) {
    for (size_t i = 0; i < sequence.rows.size(); ++i) {
      if (contains(sequence.unreadable, i)) continue;
      sum += reference_distance(sequence.rows, i, query, frame);
      ++count;
    }
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

ComponentWeights reference_common(const DescriptorRows& query, size_t frame,
                                  const ScoreBasis& basis) {
  const TrainComponents& components = basis.components;
  ComponentValues values = {};
  for (size_t l = 0; l < components.landmarks.size(); ++l) {
    const double distance =
        reference_unrounded(query.shape.element, components.rows()[l], query[frame]);
    for (size_t k = 0; k < kMaxComponents; ++k) values[k] += components.weights[l][k] * distance;
  }
  return component_weights(components, values);
}

std::vector<std::optional<size_t>> reference_schedule(const DescribedFrames& query,
                                                      const ScoreBasis& basis) {
  std::vector<std::optional<size_t>> learned(query.rows.size());
  std::vector<size_t> views;  // all keyframes, increasing
  const double least_change = kKeyframeChange * basis.typical_distance;
  for (size_t j = 0; j < query.rows.size(); ++j) {
    if (contains(query.unreadable, j)) continue;
    const size_t recent = std::min(views.size(), kKeyframeLag);
    const bool is_new =
        std::all_of(views.end() - static_cast<ptrdiff_t>(recent), views.end(), [&](size_t view) {
          return reference_distance(query.rows, view, query.rows, j) >= least_change;
        });
    if (!is_new) continue;
    views.push_back(j);
    if (views.size() > kKeyframeLag) learned[j] = views[views.size() - 1 - kKeyframeLag];
  }
  return learned;
}

/// Weighted sums of the centered distances of one training frame.
struct Sums {
  double weight = 0;
  double first = 0;
  double second = 0;
  double mean = 0;
  double variance = 0;

  void add(double x) {
    weight = kForgetting * weight + 1;
    first = kForgetting * first + x;
    second = kForgetting * second + x * x;
    mean = first / weight;
    variance = second / weight - mean * mean;
  }
};

double z_of(double x, const Sums& sums, uint16_t largest) {
  constexpr double kLimit = static_cast<double>(kScoreBias) / kScoreUnit;
  const double deviation =
      std::max(std::sqrt(std::max(sums.variance, 0.0)), deviation_floor(largest));
  return std::clamp((x - sums.mean) / deviation, -kLimit, kLimit - 1.0 / kScoreUnit);
}

}  // namespace

uint32_t reference_hamming(DescriptorRow a, DescriptorRow b) {
  uint32_t distance = 0;
  for (size_t i = 0; i < a.size(); ++i)
    distance += std::popcount(static_cast<uint8_t>(a[i] ^ b[i]));
  return distance;
}

double reference_unrounded(ElementType element, DescriptorRow a, DescriptorRow b) {
  switch (element) {
    case ElementType::bits:
      return reference_hamming(a, b);
    case ElementType::int8:
      return cosine_distance(bytes_of(a), bytes_of(b));
    case ElementType::int16:
      return cosine_distance(byte_pairs_of(a), byte_pairs_of(b));
    case ElementType::points16:
      return point_distance(byte_pairs_of(a), byte_pairs_of(b));
    case ElementType::gray_levels:
      return gray_distance(a, b);
    case ElementType::ldb_hog:
      break;
  }
  return reference_hamming(a.first(kLdbBytes), b.first(kLdbBytes)) +
         cosine_distance(bytes_of(a.subspan(kLdbBytes)), bytes_of(b.subspan(kLdbBytes))) / 256;
}

uint32_t reference_distance(ElementType element, DescriptorRow a, DescriptorRow b) {
  if (element == ElementType::ldb_hog)  // the sum of rounded distances
    return reference_hamming(a.first(kLdbBytes), b.first(kLdbBytes)) +
           (reference_distance(ElementType::int8, a.subspan(kLdbBytes), b.subspan(kLdbBytes)) +
            128) /
               256;
  return static_cast<uint32_t>(std::clamp(reference_unrounded(element, a, b) + 0.5, 0.0, 65535.0));
}

uint32_t reference_distance(const DescriptorRows& a, size_t frame_a, const DescriptorRows& b,
                            size_t frame_b) {
  assert(a.shape == b.shape);
  return reference_distance(a.shape.element, a[frame_a], b[frame_b]);
}

uint32_t reference_window_distance(const DescriptorRows& train, size_t train_window,
                                   const DescriptorRows& query, size_t query_window,
                                   size_t window_length) {
  assert(train_window + window_length <= train.size());
  assert(query_window + window_length <= query.size());
  uint32_t sum = 0;
  for (size_t k = 0; k < window_length; ++k)
    sum += reference_distance(train, train_window + k, query, query_window + k);
  return sum;
}

ReferenceUpdates reference_updates(std::span<const DescribedFrames> centered_over,
                                   const DescribedFrames& query, const ScoreBasis& basis,
                                   const Monitor& monitor) {
  ReferenceUpdates updates;
  updates.row_means.resize(query.rows.size());
  parallel_for(query.rows.size(), monitor,
               [&](size_t j) { updates.row_means[j] = mean_over(centered_over, query.rows, j); });
  updates.common.resize(query.rows.size());
  parallel_for(query.rows.size(), monitor,
               [&](size_t j) { updates.common[j] = reference_common(query.rows, j, basis); });
  updates.learned = reference_schedule(query, basis);
  return updates;
}

std::vector<double> reference_frame_scores(DescriptorRow train, size_t frame,
                                           const DescriptorRows& query,
                                           const ReferenceUpdates& updates,
                                           const ScoreBasis& basis) {
  const double weight = basis.start_weight;
  const double start = basis.mean[frame];
  Sums sums{weight, weight * start, weight * (basis.variance + start * start), start,
            basis.variance};
  const uint16_t largest = largest_distance(query.shape);
  const double unit = component_unit(query.shape);
  const auto centered = [&](size_t j) {
    return reference_distance(query.shape.element, train, query[j]) - updates.row_means[j] -
           unit * component_sum(basis.components, updates.common[j], frame);
  };
  std::vector<double> scores;
  for (size_t j = 0; j < query.size(); ++j) {
    if (updates.learned[j]) sums.add(centered(*updates.learned[j]));
    scores.push_back(z_of(centered(j), sums, largest));
  }
  return scores;
}

double score_tolerance(size_t window_length) {
  return static_cast<double>(window_length) / kScoreUnit;
}

std::vector<Cell> wrong_cells(std::span<const Cell> cells, std::span<const DescribedFrames> train,
                              const DescriptorRows& query, size_t window_length,
                              const Monitor& monitor) {
  std::vector<uint32_t> correct(cells.size());
  parallel_for(cells.size(), monitor, [&](size_t i) {
    correct[i] = reference_window_distance(train[cells[i].sequence].rows, cells[i].train_window,
                                           query, cells[i].query_window, window_length);
  });
  std::vector<Cell> wrong;
  for (size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].score == correct[i]) continue;
    wrong.push_back(cells[i]);
    wrong.back().score = correct[i];
  }
  return wrong;
}

std::vector<Cell> wrong_scores(std::span<const Cell> cells, std::span<const DescribedFrames> train,
                               const DescribedFrames& query, size_t window_length,
                               const ScoreBasis& basis, const Monitor& monitor) {
  const ReferenceUpdates updates = reference_updates(train, query, basis, monitor);
  std::vector<size_t> first_frame;
  size_t frames = 0;
  for (const DescribedFrames& sequence : train) {
    first_frame.push_back(frames);
    frames += sequence.rows.size();
  }
  std::vector<double> correct(cells.size(), 0);  // in standard deviations
  parallel_for(cells.size(), monitor, [&](size_t c) {
    const Cell& cell = cells[c];
    const size_t known = cell.query_window + window_length;  // no score depends on later frames
    for (size_t k = 0; k < window_length; ++k) {
      const size_t i = cell.train_window + k;
      const size_t frame = first_frame[cell.sequence] + i;
      correct[c] +=
          reference_frame_scores(train[cell.sequence].rows[i], frame, query.rows.first(known),
                                 updates, basis)[cell.query_window + k];
    }
  });
  const double tolerance = score_tolerance(window_length) * kScoreUnit;
  const auto bias = static_cast<int64_t>(window_length) * kScoreBias;
  std::vector<Cell> wrong;
  for (size_t c = 0; c < cells.size(); ++c) {
    const double found = static_cast<double>(cells[c].score - bias);
    const double expected = correct[c] * kScoreUnit;
    if (std::abs(found - expected) <= tolerance) continue;
    wrong.push_back(cells[c]);
    wrong.back().score = static_cast<uint32_t>(std::llround(expected) + bias);
  }
  return wrong;
}

}  // namespace vpr
