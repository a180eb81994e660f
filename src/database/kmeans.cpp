#include "database/kmeans.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "descriptors/nearest_centre.h"
#include "descriptors/vocabulary.h"

namespace vpr {
namespace {

constexpr size_t kChunk = 1024;                      // points a task
constexpr size_t kOversampleFrom = size_t{1} << 28;  // points x words from which k-means|| starts
constexpr size_t kOversampleRounds = 5;

size_t chunk_count(size_t points) { return (points + kChunk - 1) / kChunk; }

template <class Body>
void for_chunks(size_t points, const Monitor& monitor, Body&& body) {
  parallel_for(chunk_count(points), monitor,
               [&](size_t c) { body(c * kChunk, std::min(points, (c + 1) * kChunk)); });
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

// The index at which the running sum of values exceeds share * total; sums run in order.
size_t pick(const std::vector<double>& values, double share) {
  double total = 0;
  for (const double value : values) total += value;
  double left = share * total;
  size_t last_positive = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    if (values[i] <= 0) continue;
    last_positive = i;
    if (left < values[i]) return i;
    left -= values[i];
  }
  return last_positive;
}

// Lowers each point's squared distance to its nearest seed by one more seed.
void meet_seed(const cv::Mat& points, size_t seed, std::vector<double>& distances,
               const Monitor& monitor) {
  for_chunks(distances.size(), monitor, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      distances[i] = std::min(distances[i], squared_distance(points, i, points, seed));
  });
}

// k-means++ over weighted points: each seed is drawn by weight x squared distance to the nearest.
// Where all that is left coincides with seeds, the first point that is no seed follows.
std::vector<size_t> plus_plus(const cv::Mat& points, const std::vector<double>& weights,
                              size_t count, RandomEngine& engine, const Monitor& monitor) {
  const auto n = static_cast<size_t>(points.rows);
  std::vector<double> distances(n, std::numeric_limits<double>::max());
  std::vector<char> is_seed(n, 0);
  std::vector<size_t> seeds;
  std::vector<double> mass = weights;
  StepCounter counter(monitor, "seed", count);
  while (seeds.size() < count) {
    size_t next = pick(mass, uniform_unit(engine));
    if (is_seed[next] != 0)
      next = static_cast<size_t>(std::find(is_seed.begin(), is_seed.end(), 0) - is_seed.begin());
    is_seed[next] = 1;
    seeds.push_back(next);
    meet_seed(points, next, distances, monitor);
    for (size_t i = 0; i < n; ++i) mass[i] = weights[i] * distances[i];
    counter.add();
  }
  return seeds;
}

cv::Mat rows_of(const cv::Mat& points, const std::vector<size_t>& indices) {
  cv::Mat rows(static_cast<int>(indices.size()), points.cols, points.type());
  for (size_t i = 0; i < indices.size(); ++i)
    points.row(static_cast<int>(indices[i])).copyTo(rows.row(static_cast<int>(i)));
  return rows;
}

std::vector<uint32_t> assign(const cv::Mat& points, const cv::Mat& centres,
                             const Monitor& monitor) {
  const Vocabulary vocabulary = make_vocabulary(centres);
  std::vector<uint32_t> assigned(static_cast<size_t>(points.rows));
  for_chunks(assigned.size(), monitor, [&](size_t begin, size_t end) {
    const auto words =
        nearest_words(vocabulary, points.rowRange(static_cast<int>(begin), static_cast<int>(end)));
    std::copy(words.begin(), words.end(), assigned.begin() + static_cast<ptrdiff_t>(begin));
  });
  return assigned;
}

// k-means||: rounds that each draw about count / 2 candidates independently by squared distance;
// candidates are weighted by the points nearest to them, and thinned out by k-means++.
cv::Mat oversampled_seeds(const cv::Mat& points, size_t count, RandomEngine& engine,
                          const Monitor& monitor) {
  const auto n = static_cast<size_t>(points.rows);
  std::vector<size_t> candidates = {uniform_below(engine, n)};
  std::vector<double> distances(n, std::numeric_limits<double>::max());
  size_t met = 0;
  for (size_t round = 0; round < kOversampleRounds; ++round) {
    const cv::Mat fresh =
        rows_of(points, {candidates.begin() + static_cast<ptrdiff_t>(met), candidates.end()});
    const std::vector<uint32_t> nearest = assign(points, fresh, monitor);
    for_chunks(n, monitor, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        distances[i] = std::min(distances[i], squared_distance(points, i, fresh, nearest[i]));
    });
    met = candidates.size();
    double total = 0;
    for (const double distance : distances) total += distance;
    if (total <= 0) break;
    const double scale = static_cast<double>(count) / 2 / total;
    for (size_t i = 0; i < n; ++i)
      if (uniform_unit(engine) < scale * distances[i]) candidates.push_back(i);
    if (candidates.size() == met) break;
  }
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  if (candidates.size() < count) return {};
  const cv::Mat rows = rows_of(points, candidates);
  std::vector<double> weights(candidates.size(), 0);
  for (const uint32_t nearest : assign(points, rows, monitor)) weights[nearest] += 1;
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

/// Points grouped by centre: members of c are points[offsets[c]] .. points[offsets[c + 1]], rising.
struct Members {
  std::vector<size_t> offsets;
  std::vector<uint32_t> points;
};

Members group_members(const std::vector<uint32_t>& assigned, size_t centres) {
  Members members;
  members.offsets.assign(centres + 1, 0);
  for (const uint32_t c : assigned) ++members.offsets[c + 1];
  for (size_t c = 0; c < centres; ++c) members.offsets[c + 1] += members.offsets[c];
  members.points.resize(assigned.size());
  std::vector<size_t> at(members.offsets.begin(), members.offsets.end() - 1);
  for (size_t i = 0; i < assigned.size(); ++i)
    members.points[at[assigned[i]]++] = static_cast<uint32_t>(i);
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

// Moves every centre to its members; returns the indices of those that moved.
std::vector<size_t> move_centres(const cv::Mat& points, const std::vector<uint32_t>& assigned,
                                 cv::Mat& centres, const Monitor& monitor) {
  const auto count = static_cast<size_t>(centres.rows);
  const Members members = group_members(assigned, count);
  const cv::Mat before = centres.clone();
  parallel_for(count, monitor, [&](size_t c) {
    const std::span<const uint32_t> own(members.points.data() + members.offsets[c],
                                        members.offsets[c + 1] - members.offsets[c]);
    if (own.empty()) return;
    cv::Mat row = centres.row(static_cast<int>(c));
    points.type() == CV_32F ? mean_of(points, own, row) : majority_of(points, own, row);
  });
  std::vector<size_t> moved;
  for (size_t c = 0; c < count; ++c)
    if (!std::equal(centres.ptr(static_cast<int>(c)),
                    centres.ptr(static_cast<int>(c)) + centres.step[0],
                    before.ptr(static_cast<int>(c))))
      moved.push_back(c);
  return moved;
}

}  // namespace

cv::Mat kmeans_words(const cv::Mat& descriptors, const KmeansSettings& settings,
                     const Monitor& monitor) {
  const auto n = static_cast<size_t>(descriptors.rows);
  if (settings.words == 0 || settings.words > n)
    throw Error(ErrorKind::usage,
                fmt::format("{} words can't be made of {} descriptors; give fewer --words or more "
                            "--pretrain frames",
                            settings.words, n));
  RandomEngine engine(settings.seed);
  cv::Mat centres = choose_seeds(descriptors, settings.words, engine, monitor);
  std::vector<uint32_t> assigned;
  StepCounter counter(monitor, "cluster", settings.iterations);
  for (size_t step = 0; step < settings.iterations; ++step) {
    std::vector<uint32_t> now = assign(descriptors, centres, monitor);
    if (now == assigned) break;
    assigned = std::move(now);
    if (move_centres(descriptors, assigned, centres, monitor).empty()) break;
    counter.add();
  }
  return centres;
}

}  // namespace vpr
