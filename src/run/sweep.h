// A grid of settings for little more than the time of one query.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "decide/result.h"
#include "evaluate/sweep.h"
#include "run/fabmap_query.h"
#include "run/query.h"
#include "truth/ground_truth.h"

namespace vpr {

/// How to find the ground truth of a result: by the scope of its indices.
using TruthReader = std::function<GroundTruth(const GroundTruthScope&)>;

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

/// 95 % intervals of the recognitions and clusters of a result, by the block bootstrap over query
/// windows: blocks of c_l windows, for neighbors share most of their frames, or of c_w frames, but
/// at least 8.
SweepIntervals count_intervals(const Result& result, const GroundTruth& truth, uint64_t seed);

/// The counts that vpr-query and vpr-eval give for every cell, by window, then threshold, and which
/// cell to choose. Frame distances are computed once (twice with thresholds relative to the largest
/// distance): windows of all lengths come from the same pass, thresholds of one length from its
/// recognitions at the largest. `base`: the other settings, resolved with the choice kSweepChoice.
/// Each warning is said once. Throws as plan_query does, and Error(usage) where the recognitions of
/// all lengths do not fit into the memory together.
Sweep sweep_sequences(const SequenceDatabase& database, const DescriptorSet& query,
                      const std::string& query_name, const ResolvedSettings& base, const Grid& grid,
                      const TruthReader& read_truth, const QueryResources& resources,
                      const Monitor& monitor);

/// The same for FAB-MAP: from one pass of posteriors. Throws Error(usage) for settings out of
/// range, an automatic threshold, and the loop mode.
Sweep sweep_fabmap(const FabmapDatabase& database, const SequenceWords& query,
                   const std::string& query_name, const FabmapQuerySettings& base, const Grid& grid,
                   const TruthReader& read_truth, uint64_t seed, const Monitor& monitor);

}  // namespace vpr
