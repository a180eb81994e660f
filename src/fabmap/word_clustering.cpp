#include "fabmap/word_clustering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/parallel.h"
#include "fabmap/vocabulary.h"

namespace vpr {
namespace {

// Calls body(begin, end) for chunks of [0, points), in any order, from several threads.
template <class Body>
void for_chunks(size_t points, const Monitor& monitor, Body&& body) {
  constexpr size_t kChunk = 1024;
  parallel_for((points + kChunk - 1) / kChunk, monitor,
               [&](size_t c) { body(c * kChunk, std::min(points, (c + 1) * kChunk)); });
}

// begin, begin + 1, ..., end - 1.
std::vector<uint32_t> row_range(size_t begin, size_t end) {
  std::vector<uint32_t> rows(end - begin);
  std::iota(rows.begin(), rows.end(), static_cast<uint32_t>(begin));
  return rows;
}

// Whether a is nearer than b, by score; of equals the lower index is.
bool nearer(const NearestCentre& a, const NearestCentre& b) {
  return a.score < b.score || (a.score == b.score && a.centre < b.centre);
}

/// Points grouped by centre: members of c are points[offsets[c]] .. points[offsets[c + 1]], rising.
struct Members {
  std::vector<size_t> offsets;
  std::vector<uint32_t> points;
};

Members group_members(const std::vector<NearestCentre>& assigned, size_t centres) {
  Members members;
  members.offsets.assign(centres + 1, 0);
  for (const NearestCentre& own : assigned) ++members.offsets[own.centre + 1];
  for (size_t c = 0; c < centres; ++c) members.offsets[c + 1] += members.offsets[c];
  members.points.resize(assigned.size());
  std::vector<size_t> at(members.offsets.begin(), members.offsets.end() - 1);
  for (size_t i = 0; i < assigned.size(); ++i)
    members.points[at[assigned[i].centre]++] = static_cast<uint32_t>(i);
  return members;
}

// The mean of floats, summed in index order in double.
void mean_of(const cv::Mat& points, std::span<const uint32_t> members, cv::Mat centre) {
  std::vector<double> sums(static_cast<size_t>(points.cols), 0);
  for (const uint32_t i : members) {
    const auto* row = points.ptr<float>(static_cast<int>(i));
    for (size_t k = 0; k < sums.size(); ++k) sums[k] += static_cast<double>(row[k]);
  }
  for (size_t k = 0; k < sums.size(); ++k)
    centre.at<float>(0, static_cast<int>(k)) =
        static_cast<float>(sums[k] / static_cast<double>(members.size()));
}

// The bit that more than half of the members have set; 0 on a tie.
void majority_of(const cv::Mat& points, std::span<const uint32_t> members, cv::Mat centre) {
  std::vector<size_t> ones(static_cast<size_t>(points.cols) * 8, 0);
  for (const uint32_t i : members) {
    const uint8_t* row = points.ptr(static_cast<int>(i));
    for (size_t bit = 0; bit < ones.size(); ++bit) ones[bit] += row[bit / 8] >> bit % 8 & 1;
  }
  centre.setTo(0);
  for (size_t bit = 0; bit < ones.size(); ++bit)
    if (2 * ones[bit] > members.size())
      centre.data[bit / 8] = static_cast<uint8_t>(centre.data[bit / 8] | 1 << bit % 8);
}

}  // namespace

cv::Mat rows_of(const cv::Mat& points, const std::vector<size_t>& indices) {
  cv::Mat rows(static_cast<int>(indices.size()), points.cols, points.type());
  for (size_t i = 0; i < indices.size(); ++i)
    points.row(static_cast<int>(indices[i])).copyTo(rows.row(static_cast<int>(i)));
  return rows;
}

double squared_distance(const cv::Mat& a, size_t i, const cv::Mat& b, size_t j) {
  if (a.type() == CV_8U)
    return hamming_bytes(a.ptr(static_cast<int>(i)), b.ptr(static_cast<int>(j)),
                         static_cast<size_t>(a.cols));
  const auto* x = a.ptr<float>(static_cast<int>(i));
  const auto* y = b.ptr<float>(static_cast<int>(j));
  // Four sums in a fixed order, so that additions do not wait for each other.
  std::array<float, 4> sums{};
  int k = 0;
  for (; k + 4 <= a.cols; k += 4)
    for (int s = 0; s < 4; ++s)
      sums[static_cast<size_t>(s)] += (x[k + s] - y[k + s]) * (x[k + s] - y[k + s]);
  for (; k < a.cols; ++k) sums[0] += (x[k] - y[k]) * (x[k] - y[k]);
  return static_cast<double>((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

std::vector<char> move_centres(const cv::Mat& points, const std::vector<NearestCentre>& assigned,
                               cv::Mat& centres, const Monitor& monitor) {
  const auto count = static_cast<size_t>(centres.rows);
  const Members members = group_members(assigned, count);
  std::vector<char> has_moved(count, 0);
  parallel_for(count, monitor, [&](size_t c) {
    const std::span<const uint32_t> own(members.points.data() + members.offsets[c],
                                        members.offsets[c + 1] - members.offsets[c]);
    if (own.empty()) return;
    cv::Mat row = centres.row(static_cast<int>(c));
    const cv::Mat before = row.clone();
    points.type() == CV_32F ? mean_of(points, own, row) : majority_of(points, own, row);
    has_moved[c] = !std::equal(row.data, row.data + row.elemSize() * row.total(), before.data);
  });
  return has_moved;
}

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

cv::Mat choose_seeds(const cv::Mat& points, size_t count, RandomEngine& engine,
                     const Monitor& monitor) {
  const auto n = static_cast<size_t>(points.rows);
  if (n * count >= kOversampleFrom) {
    cv::Mat seeds = oversampled_seeds(points, count, engine, monitor);
    if (!seeds.empty()) return seeds;
  }
  return rows_of(points, plus_plus(points, std::vector<double>(n, 1), count, engine, monitor));
}

/// Some of the centres, whose nearest one is named by its index among all.
class CentreSubset {
 public:
  CentreSubset(const cv::Mat& centres, std::vector<size_t> indices) : indices_(std::move(indices)) {
    if (!indices_.empty()) vocabulary_ = make_vocabulary(rows_of(centres, indices_));
  }
  bool empty() const { return indices_.empty(); }
  void find_nearest(const cv::Mat& points, std::span<const uint32_t> rows,
                    NearestCentre* nearest) const {
    find_nearest_words(vocabulary_, points, rows, nearest);
    for (size_t i = 0; i < rows.size(); ++i)
      nearest[i].centre = static_cast<uint32_t>(indices_[nearest[i].centre]);
  }

 private:
  std::vector<size_t> indices_;  // rising, so that ties stay ties
  Vocabulary vocabulary_;
};

/// Which centres moved since points were assigned to them.
struct MovedCentres {
  std::vector<char> has_moved;
  CentreSubset moved;
  CentreSubset stayed;
};

MovedCentres split_centres(const cv::Mat& centres, const std::vector<char>& has_moved) {
  std::vector<size_t> moved;
  std::vector<size_t> stayed;
  for (size_t c = 0; c < has_moved.size(); ++c) (has_moved[c] != 0 ? moved : stayed).push_back(c);
  return {has_moved, {centres, std::move(moved)}, {centres, std::move(stayed)}};
}

// Makes `nearest` right again after centres moved. A centre that stayed is as far as it was, so
// not nearer than the point's own centre was: it is met only by points whose own centre moved, and
// for which no moved one is nearer than that. Exact, for a score depends on point and centre alone.
void reassign(const cv::Mat& points, const MovedCentres& centres,
              std::vector<NearestCentre>& nearest, const Monitor& monitor) {
  for_chunks(nearest.size(), monitor, [&](size_t begin, size_t end) {
    const std::vector<uint32_t> rows = row_range(begin, end);
    std::vector<NearestCentre> found(rows.size());
    centres.moved.find_nearest(points, rows, found.data());
    std::vector<uint32_t> open;
    for (size_t i = 0; i < rows.size(); ++i) {
      NearestCentre& own = nearest[begin + i];
      const bool stayed = centres.has_moved[own.centre] == 0;
      if (!stayed && !(found[i].score < own.score)) open.push_back(rows[i]);
      if (!stayed || nearer(found[i], own)) own = found[i];
    }
    if (open.empty() || centres.stayed.empty()) return;
    found.resize(open.size());
    centres.stayed.find_nearest(points, open, found.data());
    for (size_t i = 0; i < open.size(); ++i)
      if (nearer(found[i], nearest[open[i]])) nearest[open[i]] = found[i];
  });
}

constexpr size_t kRowsAtOnce = 2048;  // that meet the centres so far together

// In units of squared_distance.
double squared_radius(const cv::Mat& points, double radius) {
  return points.type() == CV_8U ? radius : radius * radius;
}

// Squared distances of the rows [begin, end) to the centres so far.
std::vector<double> distances_to(const cv::Mat& points, const std::vector<size_t>& centres,
                                 size_t begin, size_t end, const Monitor& monitor) {
  std::vector<double> distances(end - begin, std::numeric_limits<double>::infinity());
  if (centres.empty()) return distances;
  const Vocabulary vocabulary = make_vocabulary(rows_of(points, centres));
  parallel_for(distances.size(), monitor, [&](size_t i) {
    const auto row = static_cast<uint32_t>(begin + i);
    NearestCentre nearest;
    find_nearest_words(vocabulary, points, {&row, 1}, &nearest);
    distances[i] = squared_distance(points, row, points, centres[nearest.centre]);
  });
  return distances;
}

cv::Mat centre_means(const cv::Mat& points, cv::Mat centres, const Monitor& monitor) {
  const Vocabulary vocabulary = make_vocabulary(centres.clone());
  std::vector<NearestCentre> nearest(static_cast<size_t>(points.rows));
  for_chunks(nearest.size(), monitor, [&](size_t begin, size_t end) {
    find_nearest_words(vocabulary, points, row_range(begin, end), nearest.data() + begin);
  });
  move_centres(points, nearest, centres, monitor);
  return centres;
}

}  // namespace

cv::Mat kmeans_words(const cv::Mat& descriptors, const KmeansSettings& settings,
                     const Monitor& monitor) {
  const auto n = static_cast<size_t>(descriptors.rows);
  if (settings.words == 0 || settings.words > n)
    throw Error(
        ErrorKind::usage,
        fmt::format("{} words can't be made of {} descriptors; give fewer --words, more --pretrain "
                    "frames, larger pictures, or another kind of --features",
                    settings.words, n));
  RandomEngine engine(settings.seed);
  cv::Mat centres = choose_seeds(descriptors, settings.words, engine, monitor);
  std::vector<NearestCentre> nearest(n);
  std::vector<char> has_moved(settings.words, 1);
  StepCounter counter(monitor, "cluster", settings.iterations);
  for (size_t step = 0; step < settings.iterations; ++step) {
    reassign(descriptors, split_centres(centres, has_moved), nearest, monitor);
    has_moved = move_centres(descriptors, nearest, centres, monitor);
    if (std::find(has_moved.begin(), has_moved.end(), 1) == has_moved.end()) break;
    counter.add();
  }
  return centres;
}

cv::Mat radius_words(const cv::Mat& descriptors, double radius, size_t most_words,
                     const Monitor& monitor) {
  if (!(radius > 0))
    throw Error(ErrorKind::usage, fmt::format("the radius must be above 0, found {}", radius));
  if (descriptors.empty())
    throw Error(ErrorKind::usage,
                "words can't be made of no descriptors; give more --pretrain "
                "frames");
  const auto n = static_cast<size_t>(descriptors.rows);
  const double limit = squared_radius(descriptors, radius);
  std::vector<size_t> centres;
  StepCounter counter(monitor, "cluster", n);
  for (size_t begin = 0; begin < n; begin += kRowsAtOnce) {
    const size_t end = std::min(n, begin + kRowsAtOnce);
    const size_t known = centres.size();
    const std::vector<double> distances = distances_to(descriptors, centres, begin, end, monitor);
    for (size_t i = begin; i < end; ++i) {
      bool is_far = centres.empty() || distances[i - begin] > limit;
      for (size_t c = known; is_far && c < centres.size(); ++c)
        is_far = squared_distance(descriptors, i, descriptors, centres[c]) > limit;
      if (is_far) centres.push_back(i);
      counter.add();
    }
    if (centres.size() > most_words)
      throw Error(ErrorKind::usage,
                  fmt::format("a radius of {} makes more than {} words; give a larger one", radius,
                              most_words));
  }
  return centre_means(descriptors, rows_of(descriptors, centres), monitor);
}

}  // namespace vpr
