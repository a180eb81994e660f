#include "query/clustering.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace vpr {

namespace {

/// Recognitions of one query window in one training sequence: [begin, end).
struct Row {
  uint32_t sequence = 0;
  uint32_t query = 0;
  size_t begin = 0;
  size_t end = 0;
};

// By sequence, then query window.
std::vector<Row> find_rows(std::span<const Match> recognitions) {
  std::vector<Row> rows;
  for (size_t i = 0; i < recognitions.size(); ++i) {
    const Match& match = recognitions[i];
    if (rows.empty() || rows.back().query != match.query || rows.back().sequence != match.sequence)
      rows.push_back({match.sequence, match.query, i, i});
    rows.back().end = i + 1;
  }
  std::ranges::stable_sort(rows, {}, &Row::sequence);
  return rows;
}

/// reach[dy]: the largest dx for which the point (dx, dy) is inside; -1: none.
std::vector<int64_t> find_reach(const ClusterSettings& settings) {
  std::vector<int64_t> reach;
  for (int64_t dy = 0; dy <= settings.eps; ++dy) {
    int64_t dx = settings.eps;
    const auto inside = [&](int64_t x) {
      const int64_t squared = x * x + dy * dy;
      const int64_t bound = settings.eps * settings.eps;
      return settings.eps_inclusive ? squared <= bound : squared < bound;
    };
    while (dx >= 0 && !inside(dx)) --dx;
    reach.push_back(dx);
  }
  return reach;
}

class DisjointSets {
 public:
  explicit DisjointSets(size_t count) : parent_(count) {
    for (size_t i = 0; i < count; ++i) parent_[i] = static_cast<uint32_t>(i);
  }
  uint32_t root(uint32_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  // The smaller root remains: the root of a set is its first member.
  void join(uint32_t a, uint32_t b) {
    a = root(a);
    b = root(b);
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
  }

 private:
  std::vector<uint32_t> parent_;
};

// Joins every recognition of `row` with the recognitions of `earlier`, an earlier or the same row,
// that are at most `reach` columns away. Rows are sorted, so the first candidate moves to the right
// only.
void join_rows(DisjointSets& sets, std::span<const Match> recognitions, const Row& row,
               const Row& earlier, int64_t reach) {
  size_t first = earlier.begin;
  for (size_t i = row.begin; i < row.end; ++i) {
    const int64_t column = recognitions[i].train;
    while (first < earlier.end && int64_t{recognitions[first].train} < column - reach) ++first;
    const size_t end = std::min(earlier.end, i);
    for (size_t k = first; k < end && int64_t{recognitions[k].train} <= column + reach; ++k)
      sets.join(static_cast<uint32_t>(i), static_cast<uint32_t>(k));
  }
}

uint32_t rounded_mean(uint64_t sum, uint64_t count) {
  return static_cast<uint32_t>((2 * sum + count) / (2 * count));
}

void add_recognition(Cluster& cluster, const Match& recognition) {
  if (cluster.recognitions == 0) {
    cluster.sequence = recognition.sequence;
    cluster.query_first = recognition.query;
    cluster.train_first = cluster.train_last = recognition.train;
    cluster.best_score = recognition.score;
  }
  cluster.query_last = recognition.query;
  cluster.train_first = std::min(cluster.train_first, recognition.train);
  cluster.train_last = std::max(cluster.train_last, recognition.train);
  cluster.best_score = std::min(cluster.best_score, recognition.score);
  ++cluster.recognitions;
}

/// A stretch that may continue, and its last recognition.
struct OpenStretch {
  size_t run = 0;
  Match last;
};

void add_recognition(PlaceStretch& run, uint32_t index, const Match& recognition) {
  run.last_frame = recognition.query;
  run.first_place = std::min(run.first_place, recognition.train);
  run.last_place = std::max(run.last_place, recognition.train);
  run.recognitions.push_back(index);
  run.probability = std::max(run.probability, recognition.score);
}

}  // namespace

Clusters cluster_recognitions(std::span<const Match> recognitions, const ClusterSettings& settings,
                              const Monitor& monitor) {
  assert(settings.eps >= 0 && settings.eps <= kMaxEps);
  assert(recognitions.size() < std::numeric_limits<uint32_t>::max());
  DisjointSets sets(recognitions.size());
  const std::vector<Row> rows = find_rows(recognitions);
  const std::vector<int64_t> reach = find_reach(settings);
  for (size_t r = 0; r < rows.size(); ++r) {
    for (size_t back = 0; back <= r && rows[r - back].sequence == rows[r].sequence; ++back) {
      const size_t dy = rows[r].query - rows[r - back].query;
      if (dy >= reach.size() || reach[dy] < 0) break;
      check_stop(monitor);
      join_rows(sets, recognitions, rows[r], rows[r - back], reach[dy]);
    }
  }
  Clusters clusters;
  auto& [all, of_recognition] = clusters;
  of_recognition.resize(recognitions.size());
  struct Sums {
    uint64_t query = 0;
    uint64_t train = 0;
  };
  std::vector<Sums> sums;  // by cluster
  for (const Row& row : rows)
    for (size_t i = row.begin; i < row.end; ++i) {
      const uint32_t root = sets.root(static_cast<uint32_t>(i));
      if (root == i) {
        of_recognition[i] = static_cast<uint32_t>(all.size());
        all.emplace_back();
        sums.emplace_back();
      }
      of_recognition[i] = of_recognition[root];
      add_recognition(all[of_recognition[i]], recognitions[i]);
      sums[of_recognition[i]].query += recognitions[i].query;
      sums[of_recognition[i]].train += recognitions[i].train;
    }
  for (size_t c = 0; c < all.size(); ++c) {
    all[c].query_window = rounded_mean(sums[c].query, all[c].recognitions);
    all[c].train_window = rounded_mean(sums[c].train, all[c].recognitions);
  }
  return clusters;
}

Clusters cluster_paths(std::span<const Match> recognitions, std::span<const uint32_t> paths) {
  Clusters clusters;
  for (size_t r = 0; r < recognitions.size(); ++r) {
    const uint32_t path = paths[recognitions[r].query];
    const bool continues = r > 0 && path != 0 && path == paths[recognitions[r - 1].query] &&
                           recognitions[r].sequence == recognitions[r - 1].sequence;
    if (!continues) clusters.all.emplace_back();
    clusters.of_recognition.push_back(static_cast<uint32_t>(clusters.all.size() - 1));
    add_recognition(clusters.all.back(), recognitions[r]);
  }
  size_t first = 0;
  for (Cluster& path : clusters.all) {
    const Match& middle = recognitions[first + path.recognitions / 2];
    path.query_window = middle.query;
    path.train_window = middle.train;
    first += path.recognitions;
  }
  return clusters;
}

std::optional<double> mean_rate(const Cluster& path) {
  if (path.query_first == path.query_last) return std::nullopt;
  return static_cast<double>(path.train_last - path.train_first) /
         static_cast<double>(path.query_last - path.query_first);
}

std::vector<PlaceStretch> place_runs(std::span<const Match> recognitions, size_t reach,
                                     size_t reach_places) {
  std::vector<PlaceStretch> runs;
  std::vector<OpenStretch> open;
  for (uint32_t i = 0; i < recognitions.size(); ++i) {
    const Match& recognition = recognitions[i];
    std::erase_if(
        open, [&](const OpenStretch& one) { return one.last.query + reach < recognition.query; });
    const auto found = std::find_if(open.rbegin(), open.rend(), [&](const OpenStretch& one) {
      const auto [low, high] = std::minmax(one.last.train, recognition.train);
      return high - low <= reach_places;
    });
    if (found == open.rend()) {
      open.push_back({runs.size(), recognition});
      runs.push_back(
          {recognition.query, recognition.query, recognition.train, recognition.train, {}, 0});
      add_recognition(runs.back(), i, recognition);
    } else {
      add_recognition(runs[found->run], i, recognition);
      found->last = recognition;
    }
  }
  return runs;
}

}  // namespace vpr
