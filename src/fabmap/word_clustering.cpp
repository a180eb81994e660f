#include "fabmap/word_clustering.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include <opencv2/core/hal/hal.hpp>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"

namespace vpr {
namespace {

// 0, 1, ..., count - 1.
std::vector<uint32_t> all_rows(size_t count) {
  std::vector<uint32_t> rows(count);
  std::iota(rows.begin(), rows.end(), 0U);
  return rows;
}

// Calls update(row, nearest word) for each of these rows of points, from several threads.
template <class Update>
void for_nearest(const cv::Mat& words, const cv::Mat& points, std::span<const uint32_t> rows,
                 const Monitor& monitor, Update&& update) {
  constexpr size_t kChunk = 1024;
  const Vocabulary vocabulary = make_vocabulary(words);
  parallel_for((rows.size() + kChunk - 1) / kChunk, monitor, [&](size_t c) {
    const auto part = rows.subspan(c * kChunk, std::min(kChunk, rows.size() - c * kChunk));
    const std::vector<NearestCenter> found = find_nearest_words(vocabulary, points, part);
    for (size_t i = 0; i < part.size(); ++i) update(part[i], found[i]);
  });
}

// Whether a is nearer than b by score; the lower index wins a tie.
bool nearer(const NearestCenter& a, const NearestCenter& b) {
  return a.score < b.score || (a.score == b.score && a.center < b.center);
}

// The mean of floats, summed in index order in double.
void mean_of(const cv::Mat& points, std::span<const uint32_t> members, cv::Mat center) {
  std::vector<double> sums(static_cast<size_t>(points.cols), 0);
  for (const uint32_t i : members) {
    const auto* row = points.ptr<float>(static_cast<int>(i));
    for (size_t k = 0; k < sums.size(); ++k) sums[k] += static_cast<double>(row[k]);
  }
  for (size_t k = 0; k < sums.size(); ++k)
    center.at<float>(0, static_cast<int>(k)) =
        static_cast<float>(sums[k] / static_cast<double>(members.size()));
}

// Each bit by majority of the members; 0 on a tie.
void majority_of(const cv::Mat& points, std::span<const uint32_t> members, cv::Mat center) {
  std::vector<size_t> ones(static_cast<size_t>(points.cols) * 8, 0);
  for (const uint32_t i : members) {
    const uint8_t* row = points.ptr(static_cast<int>(i));
    for (size_t bit = 0; bit < ones.size(); ++bit) ones[bit] += row[bit / 8] >> bit % 8 & 1;
  }
  center.setTo(0);
  for (size_t bit = 0; bit < ones.size(); ++bit)
    if (2 * ones[bit] > members.size())
      center.data[bit / 8] = static_cast<uint8_t>(center.data[bit / 8] | 1 << bit % 8);
}

}  // namespace

cv::Mat rows_of(const cv::Mat& points, const std::vector<size_t>& indices) {
  cv::Mat rows(static_cast<int>(indices.size()), points.cols, points.type());
  for (size_t i = 0; i < indices.size(); ++i)
    points.row(static_cast<int>(indices[i])).copyTo(rows.row(static_cast<int>(i)));
  return rows;
}

double squared_distance(const cv::Mat& points, size_t i, size_t j) {
  if (points.type() == CV_8U)
    return cv::hal::normHamming(points.ptr(static_cast<int>(i)), points.ptr(static_cast<int>(j)),
                                points.cols);
  const auto* x = points.ptr<float>(static_cast<int>(i));
  const auto* y = points.ptr<float>(static_cast<int>(j));
  // Four sums in a fixed order, so that the additions are independent.
  std::array<float, 4> sums{};
  int k = 0;
  for (; k + 4 <= points.cols; k += 4)
    for (int s = 0; s < 4; ++s)
      sums[static_cast<size_t>(s)] += (x[k + s] - y[k + s]) * (x[k + s] - y[k + s]);
  for (; k < points.cols; ++k) sums[0] += (x[k] - y[k]) * (x[k] - y[k]);
  return static_cast<double>((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

std::vector<char> move_centers(const cv::Mat& points, const std::vector<NearestCenter>& assigned,
                               cv::Mat& centers, const Monitor& monitor) {
  const auto count = static_cast<size_t>(centers.rows);
  std::vector<std::vector<uint32_t>> members(count);  // increasing
  for (size_t i = 0; i < assigned.size(); ++i)
    members[assigned[i].center].push_back(static_cast<uint32_t>(i));
  std::vector<char> has_moved(count, 0);
  parallel_for(count, monitor, [&](size_t c) {
    if (members[c].empty()) return;
    cv::Mat row = centers.row(static_cast<int>(c));
    const cv::Mat before = row.clone();
    points.type() == CV_32F ? mean_of(points, members[c], row)
                            : majority_of(points, members[c], row);
    has_moved[c] = !std::equal(row.data, row.data + row.elemSize() * row.total(), before.data);
  });
  return has_moved;
}

namespace {

constexpr size_t kOversampleFrom = size_t{1} << 28;  // points x words from which k-means|| is used
constexpr size_t kOversampleRounds = 5;

// k-means++ over weighted points: each seed is drawn with probability proportional to weight x
// squared distance to the nearest seed. Candidates are proposed by distances that ignore the latest
// few seeds, and are accepted with the ratio of the true to the proposal distance: this yields the
// same distribution with one pass over the points for many seeds. If all remaining points coincide
// with seeds, the first point that is not a seed is used.
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
      if (new_seeds_.size() == kMaxNewSeeds || rejections_ == kRejections || distances_are_guesses_)
        update_distances();
      if (!(cumulative_.back() > 0))
        return add(static_cast<size_t>(std::ranges::find(is_seed_, 0) - is_seed_.begin()));
      const size_t proposal = propose(engine);
      if (is_seed_[proposal] == 0 && accept(proposal, engine)) return add(proposal);
      ++rejections_;
    }
  }

 private:
  static constexpr size_t kMaxNewSeeds = kCenterLanes;
  static constexpr size_t kRejections = 16;

  size_t add(size_t seed) {
    // The first seed is drawn by weight alone: there are no distances yet.
    distances_are_guesses_ = seeds_++ == 0;
    is_seed_[seed] = 1;
    new_seeds_.push_back(seed);
    return seed;
  }

  size_t propose(RandomEngine& engine) const {
    const double at = uniform_unit(engine) * cumulative_.back();
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), at);
    return static_cast<size_t>(std::min(found, cumulative_.end() - 1) - cumulative_.begin());
  }

  bool accept(size_t proposal, RandomEngine& engine) const {
    double distance = distances_[proposal];
    for (const size_t seed : new_seeds_)
      distance = std::min(distance, squared_distance(points_, proposal, seed));
    return uniform_unit(engine) * distances_[proposal] < distance;
  }

  void update_distances() {
    if (distances_are_guesses_)
      std::fill(distances_.begin(), distances_.end(), std::numeric_limits<double>::max());
    distances_are_guesses_ = false;
    if (!new_seeds_.empty()) {
      for_nearest(rows_of(points_, new_seeds_), points_, all_rows(distances_.size()), monitor_,
                  [&](uint32_t i, const NearestCenter& found) {
                    distances_[i] = std::min(
                        distances_[i], squared_distance(points_, i, new_seeds_[found.center]));
                  });
    }
    new_seeds_.clear();
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
  std::vector<double> distances_;  // squared distance to the nearest seed, without the new seeds
  std::vector<double> cumulative_;
  std::vector<char> is_seed_;
  std::vector<size_t> new_seeds_;
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

// k-means||: each round draws about count / 2 candidates independently by squared distance.
// Candidates are weighted by the number of points nearest to them, and reduced to seeds by
// k-means++.
cv::Mat oversampled_seeds(const cv::Mat& points, size_t count, RandomEngine& engine,
                          const Monitor& monitor) {
  const auto n = static_cast<size_t>(points.rows);
  std::vector<size_t> candidates = {uniform_below(engine, n)};
  std::vector<NearestCenter> nearest(n, {std::numeric_limits<float>::infinity(), 0});
  std::vector<double> distances(n);
  size_t compared = 0;
  const auto compare_candidates = [&] {
    const cv::Mat fresh =
        rows_of(points, {candidates.begin() + static_cast<ptrdiff_t>(compared), candidates.end()});
    for_nearest(fresh, points, all_rows(n), monitor, [&](uint32_t i, NearestCenter found) {
      found.center += static_cast<uint32_t>(compared);
      if (nearer(found, nearest[i])) nearest[i] = found;
      distances[i] = squared_distance(points, i, candidates[nearest[i].center]);
    });
    compared = candidates.size();
  };
  for (size_t round = 0; round < kOversampleRounds; ++round) {
    compare_candidates();
    double total = 0;
    for (const double distance : distances) total += distance;
    if (total <= 0) break;
    const double scale = static_cast<double>(count) / 2 / total;
    for (size_t i = 0; i < n; ++i)
      if (uniform_unit(engine) < scale * distances[i]) candidates.push_back(i);
    if (candidates.size() == compared) break;
  }
  if (candidates.size() > compared) compare_candidates();
  if (candidates.size() < count) return {};
  std::vector<double> weights(candidates.size(), 0);
  for (const NearestCenter& own : nearest) weights[own.center] += 1;
  const cv::Mat rows = rows_of(points, candidates);
  return rows_of(rows, plus_plus(rows, weights, count, engine, monitor));
}

// Updates `nearest` after centers moved. A center that did not move is no nearer than the point's
// own center was, so it is compared only with points whose own center moved and for which no moved
// center is at least as near. Exact, because a score depends only on point and center.
void reassign(const cv::Mat& points, const cv::Mat& centers, const std::vector<char>& has_moved,
              std::vector<NearestCenter>& nearest, const Monitor& monitor) {
  std::vector<size_t> moved;  // increasing, so that ties keep their order
  std::vector<size_t> stayed;
  for (size_t c = 0; c < has_moved.size(); ++c) (has_moved[c] != 0 ? moved : stayed).push_back(c);
  std::vector<char> is_open(nearest.size(), 0);
  for_nearest(rows_of(centers, moved), points, all_rows(nearest.size()), monitor,
              [&](uint32_t i, NearestCenter found) {
                found.center = static_cast<uint32_t>(moved[found.center]);
                const bool own_stayed = has_moved[nearest[i].center] == 0;
                is_open[i] = !own_stayed && !(found.score < nearest[i].score);
                if (!own_stayed || nearer(found, nearest[i])) nearest[i] = found;
              });
  if (stayed.empty()) return;
  std::vector<uint32_t> open = all_rows(nearest.size());
  std::erase_if(open, [&](uint32_t i) { return is_open[i] == 0; });
  for_nearest(rows_of(centers, stayed), points, open, monitor,
              [&](uint32_t i, NearestCenter found) {
                found.center = static_cast<uint32_t>(stayed[found.center]);
                if (nearer(found, nearest[i])) nearest[i] = found;
              });
}

constexpr size_t kRowsAtOnce = 2048;  // rows that are compared together with the centers so far

// Squared distances of the rows [begin, end) to the centers so far.
std::vector<double> distances_to(const cv::Mat& points, const std::vector<size_t>& centers,
                                 size_t begin, size_t end, const Monitor& monitor) {
  std::vector<double> distances(end - begin, std::numeric_limits<double>::infinity());
  if (centers.empty()) return distances;
  const Vocabulary vocabulary = make_vocabulary(rows_of(points, centers));
  parallel_for(distances.size(), monitor, [&](size_t i) {
    const auto row = static_cast<uint32_t>(begin + i);
    const NearestCenter nearest = find_nearest_words(vocabulary, points, {&row, 1}).front();
    distances[i] = squared_distance(points, row, centers[nearest.center]);
  });
  return distances;
}

}  // namespace

cv::Mat kmeans_words(const cv::Mat& descriptors, const KmeansSettings& settings,
                     const Monitor& monitor) {
  const auto n = static_cast<size_t>(descriptors.rows);
  if (settings.words == 0 || settings.words > n)
    throw Error(ErrorKind::usage,
                "cannot make {} words from {} descriptors; use fewer --words, more --pretrain "
                "frames, larger images, or another kind of --features",
                settings.words, n);
  RandomEngine engine(settings.seed);
  cv::Mat centers;
  if (n * settings.words >= kOversampleFrom)
    centers = oversampled_seeds(descriptors, settings.words, engine, monitor);
  if (centers.empty())
    centers = rows_of(descriptors, plus_plus(descriptors, std::vector<double>(n, 1), settings.words,
                                             engine, monitor));
  std::vector<NearestCenter> nearest(n);
  std::vector<char> has_moved(settings.words, 1);
  StepCounter counter(monitor, "cluster", settings.iterations);
  for (size_t step = 0; step < settings.iterations; ++step) {
    reassign(descriptors, centers, has_moved, nearest, monitor);
    has_moved = move_centers(descriptors, nearest, centers, monitor);
    if (std::find(has_moved.begin(), has_moved.end(), 1) == has_moved.end()) break;
    counter.add();
  }
  return centers;
}

cv::Mat radius_words(const cv::Mat& descriptors, double radius, size_t most_words,
                     const Monitor& monitor) {
  if (!(radius > 0)) throw Error(ErrorKind::usage, "the radius must be above 0, found {}", radius);
  if (descriptors.empty())
    throw Error(ErrorKind::usage,
                "cannot make words without descriptors; use more --pretrain frames");
  const auto n = static_cast<size_t>(descriptors.rows);
  // in units of squared_distance
  const double limit = descriptors.type() == CV_8U ? radius : radius * radius;
  std::vector<size_t> centers;
  StepCounter counter(monitor, "cluster", n);
  for (size_t begin = 0; begin < n; begin += kRowsAtOnce) {
    const size_t end = std::min(n, begin + kRowsAtOnce);
    const size_t known = centers.size();
    const std::vector<double> distances = distances_to(descriptors, centers, begin, end, monitor);
    for (size_t i = begin; i < end; ++i) {
      bool is_far = centers.empty() || distances[i - begin] > limit;
      for (size_t c = known; is_far && c < centers.size(); ++c)
        is_far = squared_distance(descriptors, i, centers[c]) > limit;
      if (is_far) centers.push_back(i);
      counter.add();
    }
    if (centers.size() > most_words)
      throw Error(ErrorKind::usage, "a radius of {} makes more than {} words; use a larger radius",
                  radius, most_words);
  }
  cv::Mat words = rows_of(descriptors, centers);
  std::vector<NearestCenter> nearest(n);
  for_nearest(words, descriptors, all_rows(n), monitor,
              [&](uint32_t i, const NearestCenter& found) { nearest[i] = found; });
  move_centers(descriptors, nearest, words, monitor);
  return words;
}

}  // namespace vpr
