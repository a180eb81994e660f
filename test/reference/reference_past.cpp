#include "reference/reference_past.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "match/distance_statistics.h"
#include "match/score_kernels.h"
#include "reference/reference.h"

namespace vpr {
namespace {

bool is_readable(const DescribedFrames& walk, size_t frame) {
  return !std::binary_search(walk.unreadable.begin(), walk.unreadable.end(), frame);
}

// Distances of a frame to the readable frames of its past.
std::vector<double> past_distances(const DescribedFrames& walk, size_t frame, size_t past) {
  std::vector<double> distances;
  for (size_t i = 0; i < past; ++i)
    if (is_readable(walk, i))
      distances.push_back(reference_distance(walk.rows, i, walk.rows, frame));
  return distances;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

// The keyframes, and their contributions to the statistics.
void plan_views(ReferencePast& shared, const DescribedFrames& walk) {
  std::vector<size_t> views;
  shared.learned.resize(walk.rows.size());
  bool is_started = false;
  for (size_t j = 0; j < walk.rows.size(); ++j) {
    const double least = j == 0 ? 0 : kKeyframeChange * shared.means_so_far[j - 1];
    const size_t recent = std::min(views.size(), kKeyframeLag);
    const bool is_new = std::all_of(views.end() - ptrdiff_t(recent), views.end(), [&](size_t view) {
      return reference_distance(walk.rows, view, walk.rows, j) >= least;
    });
    if (is_started && is_readable(walk, j) && is_new) {
      views.push_back(j);
      if (views.size() > kKeyframeLag) shared.learned[j] = views[views.size() - 1 - kKeyframeLag];
    }
    is_started = is_started || shared.has_past[j] != 0;
  }
}

}  // namespace

ReferencePast reference_past(const DescribedFrames& walk, std::span<const uint32_t> past,
                             const Monitor& monitor) {
  const size_t frames = walk.rows.size();
  std::vector<std::vector<double>> x(frames);  // h, then minus the row's mean
  ReferencePast shared;
  shared.row_means.resize(frames);
  parallel_for(frames, monitor, [&](size_t j) {
    if (!is_readable(walk, j)) return;
    x[j] = past_distances(walk, j, past[j]);
    shared.row_means[j] = mean_of(x[j]);
    for (double& value : x[j]) value -= shared.row_means[j];
  });
  const double unknown = unknown_deviation(largest_distance(walk.rows.shape));
  double means = 0;
  double rows = 0;
  double pairs = kStartWeight;
  double squares = pairs * unknown * unknown;
  for (size_t j = 0; j < frames; ++j) {
    shared.has_past.push_back(!x[j].empty());
    if (!x[j].empty()) {
      means += shared.row_means[j];
      ++rows;
    }
    for (const double value : x[j]) squares += value * value;
    pairs += static_cast<double>(x[j].size());
    shared.means_so_far.push_back(rows == 0 ? 0 : means / rows);
    shared.variances.push_back(squares / pairs);
  }
  plan_views(shared, walk);
  return shared;
}

std::vector<double> reference_past_scores(const DescribedFrames& walk,
                                          std::span<const uint32_t> past,
                                          const ReferencePast& shared, size_t column, size_t last) {
  constexpr double kLimit = static_cast<double>(kScoreBias) / kScoreUnit;
  const uint16_t largest = largest_distance(walk.rows.shape);
  const auto centered = [&](size_t j) {
    return reference_distance(walk.rows, column, walk.rows, j) - shared.row_means[j];
  };
  double mean = shared.has_past[column] != 0
                    ? kStartBias * (shared.row_means[column] - shared.means_so_far[column])
                    : 0;
  double variance = 0;
  double weight = kStartWeight;
  bool is_started = false;
  std::vector<double> scores(last + 1, 0);
  for (size_t j = column + 1; j <= last; ++j) {
    const auto view = shared.learned[j];
    if (view && past[*view] > column) {
      weight = kForgetting * weight + 1;
      const double step = centered(*view) - mean;
      mean += step / weight;
      variance = (1 - 1 / weight) * (variance + step * step / weight);
    }
    if (!is_started) variance = shared.variances[j];
    is_started = past[j] > column;
    const double deviation = std::max(std::sqrt(std::max(variance, 0.0)), deviation_floor(largest));
    scores[j] = std::clamp((centered(j) - mean) / deviation, -kLimit, kLimit - 1.0 / kScoreUnit);
  }
  return scores;
}

}  // namespace vpr
