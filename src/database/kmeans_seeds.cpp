#include "database/kmeans_seeds.h"

#include <algorithm>
#include <limits>

#include <opencv2/core/mat.hpp>

#include "base/json.h"
#include "database/point_groups.h"
#include "descriptors/vocabulary.h"

namespace vpr {
namespace {

constexpr size_t kOversampleFrom = size_t{1} << 28;  // points x words from which k-means|| starts
constexpr size_t kOversampleRounds = 5;

// k-means++ over weighted points: each seed is drawn by weight x squared distance to the nearest
// one. Proposals come from distances to all seeds but the latest few, and are accepted by the share
// of the true distance in it: the same distribution, with one pass over the points for many seeds.
// Where all that is left coincides with seeds, the first point that is no seed follows.
class SeedSampler {
 public:
  SeedSampler(const cv::Mat& points, const std::vector<double>& weights, const Monitor& monitor)
      : points_(points),
        weights_(weights),
        monitor_(monitor),
        distances_(weights.size(), 1),
        cumulative_(weights.size()),
        is_seed_(weights.size(), 0) {
    sum_masses();
  }

  size_t next(RandomEngine& engine) {
    for (;;) {
      if (fresh_.size() == kFreshSeeds || rejections_ == kRejections || distances_are_guesses_)
        meet_fresh_seeds();
      if (!(cumulative_.back() > 0)) return add(first_free());
      const size_t proposal = propose(engine);
      if (is_seed_[proposal] == 0 && accept(proposal, engine)) return add(proposal);
      ++rejections_;
    }
  }

 private:
  static constexpr size_t kFreshSeeds = kCentreLanes;
  static constexpr size_t kRejections = 16;

  size_t first_free() const {
    return static_cast<size_t>(std::find(is_seed_.begin(), is_seed_.end(), 0) - is_seed_.begin());
  }

  size_t add(size_t seed) {
    // The first seed is drawn by weight alone: there is no distance yet.
    distances_are_guesses_ = seeds_++ == 0;
    is_seed_[seed] = 1;
    fresh_.push_back(seed);
    return seed;
  }

  size_t propose(RandomEngine& engine) const {
    const double at = uniform_unit(engine) * cumulative_.back();
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), at);
    return static_cast<size_t>(std::min(found, cumulative_.end() - 1) - cumulative_.begin());
  }

  bool accept(size_t proposal, RandomEngine& engine) const {
    double distance = distances_[proposal];
    for (const size_t seed : fresh_)
      distance = std::min(distance, squared_distance(points_, proposal, points_, seed));
    return uniform_unit(engine) * distances_[proposal] < distance;
  }

  void meet_fresh_seeds() {
    if (distances_are_guesses_)
      std::fill(distances_.begin(), distances_.end(), std::numeric_limits<double>::max());
    distances_are_guesses_ = false;
    if (!fresh_.empty()) {
      const Vocabulary fresh = make_vocabulary(rows_of(points_, fresh_));
      for_chunks(distances_.size(), monitor_, [&](size_t begin, size_t end) {
        const std::vector<uint32_t> rows = row_range(begin, end);
        std::vector<NearestCentre> found(rows.size());
        find_nearest_words(fresh, points_, rows, found.data());
        for (size_t i = begin; i < end; ++i)
          distances_[i] =
              std::min(distances_[i],
                       squared_distance(points_, i, points_, fresh_[found[i - begin].centre]));
      });
    }
    fresh_.clear();
    rejections_ = 0;
    sum_masses();
  }

  void sum_masses() {
    double sum = 0;
    for (size_t i = 0; i < distances_.size(); ++i)
      cumulative_[i] = sum += is_seed_[i] != 0 ? 0 : weights_[i] * distances_[i];
  }

  const cv::Mat& points_;
  const std::vector<double>& weights_;
  const Monitor& monitor_;
  std::vector<double> distances_;  // squared, to the nearest seed that is not fresh
  std::vector<double> cumulative_;
  std::vector<char> is_seed_;
  std::vector<size_t> fresh_;
  size_t rejections_ = 0;
  size_t seeds_ = 0;
  bool distances_are_guesses_ = false;
};

std::vector<size_t> plus_plus(const cv::Mat& points, const std::vector<double>& weights,
                              size_t count, RandomEngine& engine, const Monitor& monitor) {
  SeedSampler sampler(points, weights, monitor);
  std::vector<size_t> seeds;
  StepCounter counter(monitor, "seed", count);
  while (seeds.size() < count) {
    seeds.push_back(sampler.next(engine));
    counter.add();
  }
  return seeds;
}

// k-means||: rounds that each draw about count / 2 candidates independently by squared distance;
// candidates are weighted by the points nearest to them, and thinned out by k-means++.
cv::Mat oversampled_seeds(const cv::Mat& points, size_t count, RandomEngine& engine,
                          const Monitor& monitor) {
  const auto n = static_cast<size_t>(points.rows);
  std::vector<size_t> candidates = {uniform_below(engine, n)};
  std::vector<NearestCentre> nearest(n, {std::numeric_limits<float>::infinity(), 0});
  std::vector<double> distances(n);
  size_t met = 0;
  const auto meet_candidates = [&] {
    const Vocabulary fresh = make_vocabulary(
        rows_of(points, {candidates.begin() + static_cast<ptrdiff_t>(met), candidates.end()}));
    for_chunks(n, monitor, [&](size_t begin, size_t end) {
      const std::vector<uint32_t> rows = row_range(begin, end);
      std::vector<NearestCentre> found(rows.size());
      find_nearest_words(fresh, points, rows, found.data());
      for (size_t i = 0; i < rows.size(); ++i) {
        found[i].centre += static_cast<uint32_t>(met);
        NearestCentre& own = nearest[begin + i];
        if (nearer(found[i], own)) own = found[i];
        distances[begin + i] = squared_distance(points, begin + i, points, candidates[own.centre]);
      }
    });
    met = candidates.size();
  };
  for (size_t round = 0; round < kOversampleRounds; ++round) {
    meet_candidates();
    double total = 0;
    for (const double distance : distances) total += distance;
    if (total <= 0) break;
    const double scale = static_cast<double>(count) / 2 / total;
    for (size_t i = 0; i < n; ++i)
      if (uniform_unit(engine) < scale * distances[i]) candidates.push_back(i);
    if (candidates.size() == met) break;
  }
  if (candidates.size() > met) meet_candidates();
  if (candidates.size() < count) return {};
  std::vector<double> weights(candidates.size(), 0);
  for (const NearestCentre& own : nearest) weights[own.centre] += 1;
  const cv::Mat rows = rows_of(points, candidates);
  return rows_of(rows, plus_plus(rows, weights, count, engine, monitor));
}

}  // namespace

cv::Mat choose_seeds(const cv::Mat& points, size_t count, RandomEngine& engine,
                     const Monitor& monitor) {
  const auto n = static_cast<size_t>(points.rows);
  if (n * count >= kOversampleFrom) {
    cv::Mat seeds = oversampled_seeds(points, count, engine, monitor);
    if (!seeds.empty()) return seeds;
  }
  return rows_of(points, plus_plus(points, std::vector<double>(n, 1), count, engine, monitor));
}

}  // namespace vpr
