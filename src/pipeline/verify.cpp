#include "pipeline/verify.h"

#include <algorithm>
#include <tuple>

#include "matching/plain.h"

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

}  // namespace

std::vector<Cell> choose_cells(const std::vector<FrameRun>& train_runs,
                               const std::vector<FrameRun>& query_runs, size_t window_length,
                               size_t count, uint64_t seed) {
  const uint64_t cols = count_windows(train_runs, window_length);
  const uint64_t rows = count_windows(query_runs, window_length);
  std::vector<Cell> cells;
  if (rows == 0 || cols == 0) return cells;
  RandomEngine engine(seed);
  const auto add = [&](uint64_t row, uint64_t col) {
    const Window train = find_window(train_runs, window_length, col);
    cells.push_back({static_cast<uint32_t>(find_window(query_runs, window_length, row).window),
                     static_cast<uint32_t>(train.sequence), static_cast<uint32_t>(train.window),
                     0});
  };
  const auto sort_unique = [&] {
    const auto key = [](const Cell& c) {
      return std::tie(c.query_window, c.sequence, c.train_window);
    };
    std::sort(cells.begin(), cells.end(),
              [&](const Cell& a, const Cell& b) { return key(a) < key(b); });
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  };
  if (rows * cols <= count) {
    for (uint64_t row = 0; row < rows; ++row)
      for (uint64_t col = 0; col < cols; ++col) add(row, col);
    sort_unique();
    return cells;
  }
  while (cells.size() < count) {
    for (size_t missing = count - cells.size(); missing > 0; --missing)
      add(uniform_below(engine, rows), uniform_below(engine, cols));
    sort_unique();
  }
  return cells;
}

std::vector<Cell> wrong_cells(std::span<const Cell> cells, std::span<const CodeSpan> train,
                              std::span<const LdbCode> query, size_t window_length) {
  std::vector<Cell> wrong;
  for (Cell cell : cells) {
    const uint32_t right = plain_window_distance(train[cell.sequence].codes, cell.train_window,
                                                 query, cell.query_window, window_length);
    if (cell.distance == right) continue;
    cell.distance = right;
    wrong.push_back(cell);
  }
  return wrong;
}

}  // namespace vpr
