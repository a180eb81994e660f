#include "decide/clustering.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace vpr {

namespace {

/// Hits of one query window: [begin, end).
struct Row {
  uint32_t query = 0;
  size_t begin = 0;
  size_t end = 0;
};

std::vector<Row> find_rows(std::span<const Match> hits) {
  std::vector<Row> rows;
  for (size_t i = 0; i < hits.size(); ++i) {
    if (rows.empty() || rows.back().query != hits[i].query) rows.push_back({hits[i].query, i, i});
    rows.back().end = i + 1;
  }
  return rows;
}

/// reach[dy]: the largest dx whose distance from the origin at height dy is inside; -1 for none.
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
  // The smaller root stays, so that a set's root is its first member.
  void join(uint32_t a, uint32_t b) {
    a = root(a);
    b = root(b);
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
  }

 private:
  std::vector<uint32_t> parent_;
};

// Joins every hit of `row` with those of `earlier` (or of itself) at most `reach` columns away.
// Both are sorted, so the first candidate only moves to the right.
void join_rows(DisjointSets& sets, std::span<const Match> hits, const Row& row, const Row& earlier,
               int64_t reach) {
  size_t first = earlier.begin;
  for (size_t i = row.begin; i < row.end; ++i) {
    const int64_t column = hits[i].train;
    while (first < earlier.end && int64_t{hits[first].train} < column - reach) ++first;
    const size_t end = std::min(earlier.end, i);
    for (size_t k = first; k < end && int64_t{hits[k].train} <= column + reach; ++k)
      sets.join(static_cast<uint32_t>(i), static_cast<uint32_t>(k));
  }
}

struct Sums {
  uint64_t query = 0;
  uint64_t train = 0;
};

uint32_t rounded_mean(uint64_t sum, uint64_t count) {
  return static_cast<uint32_t>((2 * sum + count) / (2 * count));
}

void add_hit(Cluster& cluster, const Match& hit) {
  if (cluster.hits == 0) {
    cluster.target = hit.target;
    cluster.query_first = hit.query;
    cluster.train_first = cluster.train_last = hit.train;
    cluster.best_score = hit.score;
  }
  cluster.query_last = hit.query;
  cluster.train_first = std::min(cluster.train_first, hit.train);
  cluster.train_last = std::max(cluster.train_last, hit.train);
  cluster.best_score = std::min(cluster.best_score, hit.score);
  ++cluster.hits;
}

/// A run, and the hit that it ended with so far.
struct OpenRun {
  size_t run = 0;
  Match last;
};

bool are_near(const Match& a, const Match& b, size_t reach_places) {
  return std::max(a.train, b.train) - std::min(a.train, b.train) <= reach_places;
}

void add_hit(PlaceRun& run, const Match& hit) {
  run.last_frame = hit.query;
  run.first_place = std::min(run.first_place, hit.train);
  run.last_place = std::max(run.last_place, hit.train);
  ++run.hits;
  run.probability = std::max(run.probability, hit.score);
}

}  // namespace

Clusters cluster_hits(std::span<const Match> hits, const ClusterSettings& settings,
                      const Monitor& monitor) {
  assert(settings.eps >= 0 && settings.eps <= kMaxEps);
  assert(hits.size() < std::numeric_limits<uint32_t>::max());
  DisjointSets sets(hits.size());
  const std::vector<Row> rows = find_rows(hits);
  const std::vector<int64_t> reach = find_reach(settings);
  for (size_t r = 0; r < rows.size(); ++r) {
    for (size_t back = 0; back <= r; ++back) {
      const size_t dy = rows[r].query - rows[r - back].query;
      if (dy >= reach.size() || reach[dy] < 0) break;
      check_stop(monitor);
      join_rows(sets, hits, rows[r], rows[r - back], reach[dy]);
    }
  }
  Clusters clusters;
  auto& [all, of_hit] = clusters;
  of_hit.resize(hits.size());
  std::vector<Sums> sums;
  for (size_t i = 0; i < hits.size(); ++i) {
    const uint32_t root = sets.root(static_cast<uint32_t>(i));
    if (root == i) {
      of_hit[i] = static_cast<uint32_t>(all.size());
      all.emplace_back();
      sums.emplace_back();
    }
    of_hit[i] = of_hit[root];
    add_hit(all[of_hit[i]], hits[i]);
    sums[of_hit[i]].query += hits[i].query;
    sums[of_hit[i]].train += hits[i].train;
  }
  for (size_t c = 0; c < all.size(); ++c) {
    all[c].query_window = rounded_mean(sums[c].query, all[c].hits);
    all[c].train_window = rounded_mean(sums[c].train, all[c].hits);
  }
  return clusters;
}

Clusters cluster_by_target(std::span<const Match> hits, size_t targets,
                           const ClusterSettings& settings, const Monitor& monitor) {
  std::vector<std::vector<Match>> by_target(targets);
  for (const Match& hit : hits) by_target[hit.target].push_back(hit);
  Clusters all;
  std::vector<std::vector<uint32_t>> of_hit;  // by target
  for (std::vector<Match>& own : by_target) {
    Clusters found = cluster_hits(own, settings, monitor);
    for (uint32_t& cluster : found.of_hit) cluster += static_cast<uint32_t>(all.all.size());
    all.all.insert(all.all.end(), found.all.begin(), found.all.end());
    of_hit.push_back(std::move(found.of_hit));
    std::vector<Match>().swap(own);
  }
  std::vector<size_t> next(targets, 0);
  all.of_hit.reserve(hits.size());
  for (const Match& hit : hits) all.of_hit.push_back(of_hit[hit.target][next[hit.target]++]);
  return all;
}

Clusters cluster_tracks(std::span<const Match> hits, std::span<const uint32_t> tracks) {
  Clusters clusters;
  for (size_t h = 0; h < hits.size(); ++h) {
    const uint32_t track = tracks[hits[h].query];
    const bool goes_on = h > 0 && track != 0 && track == tracks[hits[h - 1].query] &&
                         hits[h].target == hits[h - 1].target;
    if (!goes_on) clusters.all.emplace_back();
    clusters.of_hit.push_back(static_cast<uint32_t>(clusters.all.size() - 1));
    add_hit(clusters.all.back(), hits[h]);
  }
  size_t first = 0;
  for (Cluster& track : clusters.all) {
    const Match& middle = hits[first + track.hits / 2];
    track.query_window = middle.query;
    track.train_window = middle.train;
    first += track.hits;
  }
  return clusters;
}

std::optional<double> mean_rate(const Cluster& track) {
  if (track.query_first == track.query_last) return std::nullopt;
  return static_cast<double>(track.train_last - track.train_first) /
         static_cast<double>(track.query_last - track.query_first);
}

std::vector<PlaceRun> place_runs(std::span<const Match> hits, size_t reach, size_t reach_places) {
  std::vector<PlaceRun> runs;
  std::vector<OpenRun> open;
  for (const Match& hit : hits) {
    std::erase_if(open, [&](const OpenRun& one) { return one.last.query + reach < hit.query; });
    const auto found = std::find_if(open.rbegin(), open.rend(), [&](const OpenRun& one) {
      return are_near(one.last, hit, reach_places);
    });
    if (found == open.rend()) {
      open.push_back({runs.size(), hit});
      runs.push_back({hit.query, hit.query, hit.train, hit.train, 0, 0});
      add_hit(runs.back(), hit);
    } else {
      add_hit(runs[found->run], hit);
      found->last = hit;
    }
  }
  return runs;
}

}  // namespace vpr
