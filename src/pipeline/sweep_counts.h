// From the results of a sweep's cells, of either family, to counts and to a choice.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "evaluation/sweep.h"
#include "ground_truth/ground_truth.h"
#include "recognition/result.h"

namespace vpr {

/// Windows by thresholds: c_l and t_r, or c_w and t_p.
struct Grid {
  std::vector<uint64_t> windows;
  std::vector<std::optional<double>> thresholds;  ///< none: automatic, of t_r
};

/// The grid of a sweep that is finished: further queries get the same, whatever fits them.
Grid grid_of(std::span<const CellCounts> cells);

/// Of a cell of margins: CellCounts::untrained.
using UntrainedWindows = std::function<std::optional<uint64_t>(size_t cell)>;

/// Counts every cell, by window, then threshold, and chooses. `shape`: the result before anything
/// is found; `result_of` gives a cell's, from any thread, and `untrained_of`, where there is one,
/// CellCounts::untrained.
Sweep count_cells(const Result& shape, const Grid& grid,
                  const std::function<Result(size_t cell)>& result_of, const GroundTruth& truth,
                  uint64_t seed, const Monitor& monitor, const UntrainedWindows& untrained_of = {});

/// 95 % intervals of the hits and clusters of a result, by the block bootstrap over query windows:
/// blocks of c_l windows, for neighbours share most of their frames, or of c_w frames, but at least
/// 8.
SweepIntervals count_intervals(const Result& result, const GroundTruth& truth, uint64_t seed);

}  // namespace vpr
