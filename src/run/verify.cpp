#include "run/verify.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "base/error.h"
#include "base/parallel.h"
#include "match/lsh.h"
#include "match/match.h"
#include "match/plain.h"
#include "match/score_kernels.h"

namespace vpr {
namespace {

struct Window {
  size_t sequence = 0;
  size_t window = 0;
};

// The index-th window, counted over all runs.
Window find_window(const std::vector<FrameRun>& runs, size_t window_length, uint64_t index) {
  for (const FrameRun& run : runs) {
    const size_t windows = run.windows(window_length);
    if (index < windows) return {run.sequence, run.first_in_sequence + index};
    index -= windows;
  }
  return {};
}

// How many windows end before a training frame.
uint64_t past_windows(const std::vector<FrameRun>& runs, size_t window_length, size_t past) {
  uint64_t windows = 0;
  for (const FrameRun& run : runs) {
    const size_t end = std::min(run.first + run.count, past);
    if (end >= run.first + window_length) windows += end - run.first - window_length + 1;
  }
  return windows;
}

// By query window, over all runs, how many cells there are up to its last one.
std::vector<uint64_t> row_ends(const CellRuns& runs, size_t window_length) {
  std::vector<uint64_t> ends;
  uint64_t cells = 0;
  const uint64_t all = count_windows(runs.train, window_length);
  for (const FrameRun& run : runs.query)
    for (size_t window = 0; window < run.windows(window_length); ++window) {
      const size_t end = run.first + window + window_length - 1;
      cells += runs.past.empty() ? all : past_windows(runs.train, window_length, runs.past[end]);
      ends.push_back(cells);
    }
  return ends;
}

// Up to `count` different numbers below `bound`: Floyd's algorithm, one draw each.
std::unordered_set<uint64_t> choose_indices(uint64_t bound, uint64_t count, uint64_t seed) {
  RandomEngine engine(seed);
  std::unordered_set<uint64_t> chosen;
  for (uint64_t j = bound - std::min(bound, count); j < bound; ++j) {
    const uint64_t drawn = uniform_below(engine, j + 1);
    if (!chosen.insert(drawn).second) chosen.insert(j);
  }
  return chosen;
}

// `right`, by cell, is in deviations.
std::vector<Cell> wrong_beyond_tolerance(std::span<const Cell> cells,
                                         const std::vector<double>& right, size_t window_length) {
  const double tolerance = score_tolerance(window_length) * kScoreUnit;
  std::vector<Cell> wrong;
  for (size_t c = 0; c < cells.size(); ++c) {
    const double found = static_cast<double>(cells[c].score - score_offset(window_length));
    const double expected = right[c] * kScoreUnit;
    if (std::abs(found - expected) <= tolerance) continue;
    wrong.push_back(cells[c]);
    wrong.back().score =
        static_cast<uint32_t>(std::llround(expected) + score_offset(window_length));
  }
  return wrong;
}

}  // namespace

std::vector<Cell> choose_cells(const CellRuns& runs, size_t window_length, size_t count,
                               uint64_t seed) {
  if (count == 0) return {};
  const std::vector<uint64_t> ends = row_ends(runs, window_length);
  std::vector<Cell> cells;
  for (const uint64_t index : choose_indices(ends.empty() ? 0 : ends.back(), count, seed)) {
    const auto row = std::upper_bound(ends.begin(), ends.end(), index);
    const uint64_t column = index - (row == ends.begin() ? 0 : *(row - 1));
    const Window query =
        find_window(runs.query, window_length, static_cast<uint64_t>(row - ends.begin()));
    const Window train = find_window(runs.train, window_length, column);
    cells.push_back({static_cast<uint32_t>(query.window), static_cast<uint32_t>(train.sequence),
                     static_cast<uint32_t>(train.window), 0});
  }
  std::sort(cells.begin(), cells.end(), by_position);
  return cells;
}

std::vector<Cell> wrong_cells(std::span<const Cell> cells, std::span<const DescriptorSpan> train,
                              const DescriptorRows& query, size_t window_length,
                              const Monitor& monitor) {
  std::vector<uint32_t> right(cells.size());
  parallel_for(cells.size(), monitor, [&](size_t i) {
    right[i] = plain_window_distance(train[cells[i].sequence].rows, cells[i].train_window, query,
                                     cells[i].query_window, window_length);
  });
  std::vector<Cell> wrong;
  for (size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].score == right[i]) continue;
    wrong.push_back(cells[i]);
    wrong.back().score = right[i];
  }
  return wrong;
}

std::vector<Cell> wrong_scores(std::span<const Cell> cells, std::span<const DescriptorSpan> train,
                               const DescriptorSpan& query, size_t window_length,
                               const ScoreBasis& basis, const Monitor& monitor) {
  const PlainUpdates updates = plain_updates(train, query, basis, monitor);
  std::vector<size_t> first_frame;
  size_t frames = 0;
  for (const DescriptorSpan& sequence : train) {
    first_frame.push_back(frames);
    frames += sequence.rows.size();
  }
  std::vector<double> right(cells.size(), 0);
  parallel_for(cells.size(), monitor, [&](size_t c) {
    const Cell& cell = cells[c];
    // Only an offline score depends on frames behind the window.
    const size_t known = basis.offline ? query.rows.size() : cell.query_window + window_length;
    for (size_t k = 0; k < window_length; ++k) {
      const size_t i = cell.train_window + k;
      const size_t frame = first_frame[cell.sequence] + i;
      right[c] += plain_frame_scores(train[cell.sequence].rows[i], frame, query.rows.first(known),
                                     updates, basis)[cell.query_window + k];
    }
  });
  return wrong_beyond_tolerance(cells, right, window_length);
}

}  // namespace vpr
