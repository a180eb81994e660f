// Recomputes randomly chosen cells of a score matrix by their definition.
#pragma once

#include <span>
#include <vector>

#include "base/monitor.h"
#include "base/random.h"
#include "decide/query_settings.h"
#include "decide/row_scan.h"
#include "match/zscore_model.h"

namespace vpr {

/// Where cells may be chosen.
struct CellRuns {
  std::vector<FrameRun> train;
  std::vector<FrameRun> query;
  std::vector<uint32_t> past = {};  ///< as FrameDistances has it
};

/// Up to `count` different cells of valid window pairs, uniformly chosen, sorted as CellScan needs
/// them; fewer where the matrix is smaller. Their score is not set.
std::vector<Cell> choose_cells(const CellRuns& runs, size_t window_length, size_t count,
                               uint64_t seed);

/// The cells whose score is not that of the plain scalar definition, with the right score.
std::vector<Cell> wrong_cells(std::span<const Cell> cells, std::span<const DescriptorSpan> train,
                              const DescriptorRows& query, size_t window_length,
                              const Monitor& monitor);

/// The same for z-scores, as biased sums: the cells that are farther than
/// score_tolerance from the plain oracle, with its score rounded to fixed point. `basis`: of all
/// sequences.
std::vector<Cell> wrong_scores(std::span<const Cell> cells, std::span<const DescriptorSpan> train,
                               const DescriptorSpan& query, size_t window_length,
                               const ScoreBasis& basis, const Monitor& monitor);

}  // namespace vpr
