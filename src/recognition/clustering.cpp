#include "recognition/clustering.h"

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

std::vector<Row> find_rows(std::span<const Cell> hits) {
  std::vector<Row> rows;
  for (size_t i = 0; i < hits.size(); ++i) {
    if (rows.empty() || rows.back().query != hits[i].query_window)
      rows.push_back({hits[i].query_window, i, i});
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
void join_rows(DisjointSets& sets, std::span<const Cell> hits, const Row& row, const Row& earlier,
               int64_t reach) {
  size_t first = earlier.begin;
  for (size_t i = row.begin; i < row.end; ++i) {
    const int64_t column = hits[i].train_window;
    while (first < earlier.end && int64_t{hits[first].train_window} < column - reach) ++first;
    const size_t end = std::min(earlier.end, i);
    for (size_t k = first; k < end && int64_t{hits[k].train_window} <= column + reach; ++k)
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

void add_hit(Recognition& place, Sums& sums, const Cell& hit) {
  if (place.hits == 0) {
    place.sequence = hit.sequence;
    place.query_first = hit.query_window;
    place.train_first = place.train_last = hit.train_window;
    place.best_distance = hit.distance;
  }
  place.query_last = hit.query_window;
  place.train_first = std::min(place.train_first, hit.train_window);
  place.train_last = std::max(place.train_last, hit.train_window);
  place.best_distance = std::min(place.best_distance, hit.distance);
  ++place.hits;
  sums.query += hit.query_window;
  sums.train += hit.train_window;
}

}  // namespace

Clusters cluster_hits(std::span<const Cell> hits, const ClusterSettings& settings,
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
  auto& [places, place_of] = clusters;
  place_of.resize(hits.size());
  std::vector<Sums> sums;
  for (size_t i = 0; i < hits.size(); ++i) {
    const uint32_t root = sets.root(static_cast<uint32_t>(i));
    if (root == i) {
      place_of[i] = static_cast<uint32_t>(places.size());
      places.emplace_back();
      sums.emplace_back();
    }
    place_of[i] = place_of[root];
    add_hit(places[place_of[i]], sums[place_of[i]], hits[i]);
  }
  for (size_t p = 0; p < places.size(); ++p) {
    places[p].query_window = rounded_mean(sums[p].query, places[p].hits);
    places[p].train_window = rounded_mean(sums[p].train, places[p].hits);
  }
  return clusters;
}

Clusters cluster_by_sequence(std::span<const Cell> hits, size_t sequences,
                             const ClusterSettings& settings, const Monitor& monitor) {
  std::vector<std::vector<Cell>> by_sequence(sequences);
  for (const Cell& hit : hits) by_sequence[hit.sequence].push_back(hit);
  Clusters all;
  std::vector<std::vector<uint32_t>> place_of;  // by sequence
  for (std::vector<Cell>& own : by_sequence) {
    Clusters found = cluster_hits(own, settings, monitor);
    for (uint32_t& place : found.place_of) place += static_cast<uint32_t>(all.places.size());
    all.places.insert(all.places.end(), found.places.begin(), found.places.end());
    place_of.push_back(std::move(found.place_of));
    std::vector<Cell>().swap(own);
  }
  std::vector<size_t> next(sequences, 0);
  all.place_of.reserve(hits.size());
  for (const Cell& hit : hits) all.place_of.push_back(place_of[hit.sequence][next[hit.sequence]++]);
  return all;
}

}  // namespace vpr
