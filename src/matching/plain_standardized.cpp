#include "matching/plain_standardized.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "matching/distance_statistics.h"
#include "matching/plain.h"
#include "matching/score_kernels.h"

namespace vpr {
namespace {

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
    for (size_t k = 0; k < kMostComponents; ++k) values[k] += components.weights[l][k] * distance;
  }
  return common_weights(components, basis.settings.components, values);
}

std::vector<std::optional<size_t>> plain_schedule(const DescriptorSpan& query,
                                                  const ScoreBasis& basis) {
  std::vector<std::optional<size_t>> learned(query.rows.size());
  std::vector<size_t> views;  // every new one, rising
  const double least_change = basis.settings.view_change * basis.typical_distance;
  const size_t lag = basis.settings.lag_views;
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

/// Weighted sums of the centred distances of one training frame.
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

double standardized(double x, const Sums& sums, const StandardizationSettings& settings,
                    uint16_t largest) {
  constexpr double kLimit = static_cast<double>(kScoreBias) / kScoreUnit;
  const double deviation = settings.divide ? std::max(std::sqrt(std::max(sums.variance, 0.0)),
                                                      deviation_floor(settings, largest))
                                           : unknown_deviation(largest);
  return std::clamp((x - sums.mean) / deviation, -kLimit, kLimit - 1.0 / kScoreUnit);
}

}  // namespace

PlainUpdates plain_updates(std::span<const DescriptorSpan> centred_over,
                           const DescriptorSpan& query, const ScoreBasis& basis,
                           const Monitor& monitor) {
  PlainUpdates updates;
  updates.row_means.assign(query.rows.size(), basis.typical_distance);
  if (basis.settings.centre)
    parallel_for(query.rows.size(), monitor,
                 [&](size_t j) { updates.row_means[j] = mean_over(centred_over, query.rows, j); });
  updates.common.resize(query.rows.size());
  parallel_for(query.rows.size(), monitor,
               [&](size_t j) { updates.common[j] = plain_common(query.rows, j, basis); });
  updates.learned = plain_schedule(query, basis);
  return updates;
}

std::vector<double> plain_frame_scores(DescriptorRow train, size_t frame,
                                       const DescriptorRows& query, const PlainUpdates& updates,
                                       const ScoreBasis& basis) {
  const StandardizationSettings& settings = basis.settings;
  const double weight = basis.offline ? settings.offline_start_weight : settings.start_weight;
  const double forgetting = basis.offline ? 1 : settings.forgetting;
  const double start = basis.mean[frame];
  Sums sums{weight, weight * start, weight * (basis.variance + start * start), start,
            basis.variance};
  const auto plain = distance_of(query.shape.element).plain;
  const uint16_t largest = largest_distance(query.shape);
  const double unit = common_unit(query.shape);
  const auto centred = [&](size_t j) {
    return plain(train, query[j]) - updates.row_means[j] -
           unit * common_sum(basis.components, updates.common[j], frame);
  };
  if (basis.offline)
    for (const auto& view : updates.learned)
      if (view) sums.add(centred(*view), forgetting);
  std::vector<double> scores;
  for (size_t j = 0; j < query.size(); ++j) {
    if (!basis.offline && updates.learned[j]) sums.add(centred(*updates.learned[j]), forgetting);
    scores.push_back(standardized(centred(j), sums, settings, largest));
  }
  return scores;
}

double score_tolerance(size_t window_length) {
  return static_cast<double>(window_length) / kScoreUnit;
}

}  // namespace vpr
