// Recomputes randomly chosen cells of a score matrix by their definition.
#pragma once

#include <span>
#include <vector>

#include "base/monitor.h"
#include "base/random.h"
#include "matching/standardization.h"
#include "recognition/row_scan.h"

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

/// Up to `count` different ones of the cells that an approximate method found, hits and best
/// matches, uniformly chosen and sorted in the same way; all where there are fewer.
std::vector<Cell> choose_found(const HitScanResult& found, size_t count, uint64_t seed);

/// The cells whose score is not that of the plain scalar definition, with the right score.
std::vector<Cell> wrong_cells(std::span<const Cell> cells, std::span<const DescriptorSpan> train,
                              const DescriptorRows& query, size_t window_length,
                              const Monitor& monitor);

/// The same where the distances of the query are given: sums of single scores of the matrix.
std::vector<Cell> wrong_given_cells(std::span<const Cell> cells,
                                    std::span<const DescriptorSpan> train,
                                    const DescriptorSpan& query, size_t window_length,
                                    const Monitor& monitor);

/// The same for standardized scores, as biased sums: the cells that are farther than
/// score_tolerance from the plain oracle, with its score rounded to fixed point. `basis`: of all
/// sequences, but its fusion is of those that are searched.
std::vector<Cell> wrong_scores(std::span<const Cell> cells, std::span<const DescriptorSpan> train,
                               const DescriptorSpan& query, size_t window_length,
                               const ScoreBasis& basis, const Monitor& monitor);

/// The same of a walk against its own past.
std::vector<Cell> wrong_past_scores(std::span<const Cell> cells, const DescriptorSpan& walk,
                                    std::span<const uint32_t> past, size_t window_length,
                                    const StandardizationSettings& settings,
                                    const Monitor& monitor);

struct RatedWindows {
  size_t length = 1;
  std::vector<Rate> rates;  ///< at least one
};

/// The same for windows of several rates, of distances or, with a basis, of standardized scores. A
/// cell that no window of any rate fits is not wrong.
std::vector<Cell> wrong_rated_cells(std::span<const Cell> cells, const RatedWindows& windows,
                                    std::span<const DescriptorSpan> train,
                                    const DescriptorSpan& query, const ScoreBasis* basis,
                                    const Monitor& monitor);

}  // namespace vpr
