// Random cells of a query, whose scores are compared with a reference implementation.
#pragma once

#include <cstdint>
#include <vector>

#include "match/match.h"

namespace vpr {

/// Records the scores of chosen cells. `cells` must be sorted by query window, sequence and train
/// window, without duplicates.
class CellScan {
 public:
  explicit CellScan(std::vector<Cell> cells) : cells_(std::move(cells)) {}
  void operator()(const ScoreRow& row);
  const std::vector<Cell>& result() const { return cells_; }

 private:
  std::vector<Cell> cells_;  // each is written by one row only
};

/// Up to `count` different cells of pairs of windows in runs, uniformly chosen, in the order of
/// CellScan and without scores; fewer if the matrix is smaller. The past is not considered.
std::vector<Cell> choose_cells(const FrameDistances& distances, size_t window_length, size_t count,
                               uint64_t seed);

}  // namespace vpr
