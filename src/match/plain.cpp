#include "match/plain.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "match/distance_statistics.h"
#include "match/frame_distances.h"
#include "match/score_kernels.h"

namespace vpr {

namespace {

constexpr std::array<uint8_t, 256> bit_counts() {
  std::array<uint8_t, 256> counts{};
  for (size_t value = 0; value < counts.size(); ++value)
    counts[value] = static_cast<uint8_t>(counts[value / 2] + value % 2);
  return counts;
}

constexpr std::array<uint8_t, 256> kBitCounts = bit_counts();

// Bytes as two's complement integers.
std::vector<int64_t> signed_values(DescriptorRow row) {
  std::vector<int64_t> values;
  for (const uint8_t byte : row) values.push_back(byte < 128 ? byte : byte - 256);
  return values;
}

// Pairs of bytes as little-endian two's complement integers.
std::vector<int64_t> wide_values(DescriptorRow row) {
  std::vector<int64_t> values;
  for (size_t i = 0; i < row.size(); i += 2) {
    const int64_t value = row[i] + 256 * int64_t{row[i + 1]};
    values.push_back(value < 32768 ? value : value - 65536);
  }
  return values;
}

double cosine_of(const std::vector<int64_t>& a, const std::vector<int64_t>& b) {
  int64_t product = 0;
  int64_t square_a = 0;
  int64_t square_b = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    product += a[i] * b[i];
    square_a += a[i] * a[i];
    square_b += b[i] * b[i];
  }
  const double lengths =
      std::sqrt(static_cast<double>(square_a)) * std::sqrt(static_cast<double>(square_b));
  const double cosine = lengths > 0 ? static_cast<double>(product) / lengths : 0;
  return (1 - cosine) * 65535 / 2;
}

uint32_t rounded(double cosine) {
  return static_cast<uint32_t>(std::clamp(cosine + 0.5, 0.0, 65535.0));
}

bool contains(std::span<const size_t> frames, size_t frame) {
  return std::binary_search(frames.begin(), frames.end(), frame);
}

double mean_over(std::span<const DescriptorSpan> sequences, const DescriptorRows& query,
                 size_t frame) {
  double sum = 0;
  size_t count = 0;
  for (const DescriptorSpan& sequence : sequences) {
    for (size_t i = 0; i < sequence.rows.size(); ++i) {
      if (contains(sequence.unreadable, i)) continue;
      sum += plain_distance(sequence.rows, i, query, frame);
      ++count;
    }
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

CommonWeights plain_common(const DescriptorRows& query, size_t frame, const ScoreBasis& basis) {
  const TrainComponents& components = basis.components;
  const auto unrounded = distance_of(query.shape.element).unrounded;
  ComponentValues values = {};
  for (size_t l = 0; l < components.landmarks.size(); ++l) {
    const double distance = unrounded(components.rows()[l], query[frame]);
    for (size_t k = 0; k < kMaxComponents; ++k) values[k] += components.weights[l][k] * distance;
  }
  return common_weights(components, basis.settings.components, values);
}

std::vector<std::optional<size_t>> plain_schedule(const DescriptorSpan& query,
                                                  const ScoreBasis& basis) {
  std::vector<std::optional<size_t>> learned(query.rows.size());
  std::vector<size_t> views;  // all keyframes, increasing
  const double least_change = basis.settings.keyframe_change * basis.typical_distance;
  const size_t lag = basis.settings.lag_keyframes;
  for (size_t j = 0; j < query.rows.size(); ++j) {
    if (contains(query.unreadable, j) || !basis.settings.learn) continue;
    const size_t recent = std::min(views.size(), lag);
    const bool is_new =
        std::all_of(views.end() - static_cast<ptrdiff_t>(recent), views.end(), [&](size_t view) {
          return plain_distance(query.rows, view, query.rows, j) >= least_change;
        });
    if (!is_new) continue;
    views.push_back(j);
    if (basis.offline)
      learned[j] = j;
    else if (views.size() > lag)
      learned[j] = views[views.size() - 1 - lag];
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

  void add(double x, double forgetting) {
    weight = forgetting * weight + 1;
    first = forgetting * first + x;
    second = forgetting * second + x * x;
    mean = first / weight;
    variance = second / weight - mean * mean;
  }
};

double zscores(double x, const Sums& sums, const ZScoreSettings& settings, uint16_t largest) {
  constexpr double kLimit = static_cast<double>(kScoreBias) / kScoreUnit;
  const double deviation = settings.divide ? std::max(std::sqrt(std::max(sums.variance, 0.0)),
                                                      deviation_floor(settings, largest))
                                           : unknown_deviation(largest);
  return std::clamp((x - sums.mean) / deviation, -kLimit, kLimit - 1.0 / kScoreUnit);
}

}  // namespace

uint32_t plain_hamming(DescriptorRow a, DescriptorRow b) {
  uint32_t distance = 0;
  for (size_t i = 0; i < a.size(); ++i) distance += kBitCounts[a[i] ^ b[i]];
  return distance;
}

double plain_hamming_unrounded(DescriptorRow a, DescriptorRow b) { return plain_hamming(a, b); }

double plain_cosine_unrounded(DescriptorRow a, DescriptorRow b) {
  return cosine_of(signed_values(a), signed_values(b));
}

double plain_wide_cosine_unrounded(DescriptorRow a, DescriptorRow b) {
  return cosine_of(wide_values(a), wide_values(b));
}

uint32_t plain_cosine(DescriptorRow a, DescriptorRow b) {
  return rounded(plain_cosine_unrounded(a, b));
}

uint32_t plain_wide_cosine(DescriptorRow a, DescriptorRow b) {
  return rounded(plain_wide_cosine_unrounded(a, b));
}

double plain_point_unrounded(DescriptorRow a, DescriptorRow b) {
  const std::vector<int64_t> from = wide_values(a);
  const std::vector<int64_t> to = wide_values(b);
  double sum = 0;
  for (size_t i = 0; i < from.size(); ++i)
    sum += static_cast<double>((from[i] - to[i]) * (from[i] - to[i]));
  return std::sqrt(sum);
}

uint32_t plain_point(DescriptorRow a, DescriptorRow b) {
  return static_cast<uint32_t>(std::floor(plain_point_unrounded(a, b) + 0.5));
}

double plain_gray_unrounded(DescriptorRow a, DescriptorRow b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return 256 * sum / static_cast<double>(a.size());
}

uint32_t plain_gray(DescriptorRow a, DescriptorRow b) {
  return static_cast<uint32_t>(std::floor(plain_gray_unrounded(a, b) + 0.5));
}

uint32_t plain_distance(const DescriptorRows& a, size_t frame_a, const DescriptorRows& b,
                        size_t frame_b) {
  assert(a.shape == b.shape);
  return distance_of(a.shape.element).plain(a[frame_a], b[frame_b]);
}

uint32_t plain_window_distance(const DescriptorRows& train, size_t train_window,
                               const DescriptorRows& query, size_t query_window,
                               size_t window_length) {
  assert(train_window + window_length <= train.size());
  assert(query_window + window_length <= query.size());
  uint32_t sum = 0;
  for (size_t k = 0; k < window_length; ++k)
    sum += plain_distance(train, train_window + k, query, query_window + k);
  return sum;
}

PlainUpdates plain_updates(std::span<const DescriptorSpan> centered_over,
                           const DescriptorSpan& query, const ScoreBasis& basis,
                           const Monitor& monitor) {
  PlainUpdates updates;
  updates.row_means.assign(query.rows.size(), basis.typical_distance);
  if (basis.settings.center)
    parallel_for(query.rows.size(), monitor,
                 [&](size_t j) { updates.row_means[j] = mean_over(centered_over, query.rows, j); });
  updates.common.resize(query.rows.size());
  parallel_for(query.rows.size(), monitor,
               [&](size_t j) { updates.common[j] = plain_common(query.rows, j, basis); });
  updates.learned = plain_schedule(query, basis);
  return updates;
}

std::vector<double> plain_frame_scores(DescriptorRow train, size_t frame,
                                       const DescriptorRows& query, const PlainUpdates& updates,
                                       const ScoreBasis& basis) {
  const ZScoreSettings& settings = basis.settings;
  const double weight = basis.offline ? settings.offline_start_weight : settings.start_weight;
  const double forgetting = basis.offline ? 1 : settings.forgetting;
  const double start = basis.mean[frame];
  Sums sums{weight, weight * start, weight * (basis.variance + start * start), start,
            basis.variance};
  const auto plain = distance_of(query.shape.element).plain;
  const uint16_t largest = largest_distance(query.shape);
  const double unit = common_unit(query.shape);
  const auto centered = [&](size_t j) {
    return plain(train, query[j]) - updates.row_means[j] -
           unit * common_sum(basis.components, updates.common[j], frame);
  };
  if (basis.offline)
    for (const auto& view : updates.learned)
      if (view) sums.add(centered(*view), forgetting);
  std::vector<double> scores;
  for (size_t j = 0; j < query.size(); ++j) {
    if (!basis.offline && updates.learned[j]) sums.add(centered(*updates.learned[j]), forgetting);
    scores.push_back(zscores(centered(j), sums, settings, largest));
  }
  return scores;
}

double score_tolerance(size_t window_length) {
  return static_cast<double>(window_length) / kScoreUnit;
}

}  // namespace vpr
