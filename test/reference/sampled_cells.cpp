#include "reference/sampled_cells.h"

#include <algorithm>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "base/random.h"

namespace vpr {
namespace {

// The sequence and index of the index-th window, counted over all runs.
std::pair<size_t, size_t> find_window(const std::vector<FrameStretch>& runs, size_t window_length,
                                      uint64_t index) {
  for (const FrameStretch& run : runs) {
    const size_t windows = run.windows(window_length);
    if (index < windows) return {run.sequence, run.first_in_sequence + index};
    index -= windows;
  }
  return {};
}

// Up to `count` different numbers below `bound`, by Floyd's algorithm.
std::unordered_set<uint64_t> choose_indices(uint64_t bound, uint64_t count, uint64_t seed) {
  RandomEngine engine(seed);
  std::unordered_set<uint64_t> chosen;
  for (uint64_t j = bound - std::min(bound, count); j < bound; ++j) {
    const uint64_t drawn = uniform_below(engine, j + 1);
    if (!chosen.insert(drawn).second) chosen.insert(j);
  }
  return chosen;
}

bool by_position(const Cell& a, const Cell& b) {
  return std::tie(a.query_window, a.sequence, a.train_window) <
         std::tie(b.query_window, b.sequence, b.train_window);
}

}  // namespace

void CellScan::operator()(const ScoreRow& row) {
  const Cell first{static_cast<uint32_t>(row.query_window), static_cast<uint32_t>(row.sequence),
                   static_cast<uint32_t>(row.train_window), 0};
  for (auto cell = std::lower_bound(cells_.begin(), cells_.end(), first, by_position);
       cell != cells_.end() && cell->query_window == row.query_window &&
       cell->sequence == row.sequence && cell->train_window - row.train_window < row.scores.size();
       ++cell)
    cell->score = row.scores[cell->train_window - row.train_window];
}

std::vector<Cell> choose_cells(const FrameDistances& distances, size_t window_length, size_t count,
                               uint64_t seed) {
  const uint64_t columns = count_windows(distances.train_runs, window_length);
  const uint64_t all = columns * count_windows(distances.query_runs, window_length);
  std::vector<Cell> cells;
  for (const uint64_t index : choose_indices(all, count, seed)) {
    const size_t query = find_window(distances.query_runs, window_length, index / columns).second;
    const auto [sequence, train] =
        find_window(distances.train_runs, window_length, index % columns);
    cells.push_back({static_cast<uint32_t>(query), static_cast<uint32_t>(sequence),
                     static_cast<uint32_t>(train), 0});
  }
  std::sort(cells.begin(), cells.end(), by_position);
  return cells;
}

}  // namespace vpr
