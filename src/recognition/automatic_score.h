// The automatic t_r of standardized scores: how close training sequences come to each other.
#pragma once

#include "database/sequence_database.h"
#include "matching/rows.h"
#include "matching/standardization.h"

namespace vpr {

/// Every training sequence is a query against all others, with the scores that a query would have:
/// for each sequence, the window of any other one that scores lowest against any of its own. Unlike
/// distances, scores are not the same in both directions, and those with the sequence as training
/// data count. ClosestWindows::distance is a biased sum (matching/score_kernels.h). `basis`: of all
/// sequences together. Ties: smallest own window, then sequence, then window. One entry a sequence,
/// none where it, or every other, is shorter than a window. Throws what match_standardized throws.
std::vector<std::optional<ClosestWindows>> find_closest_scores(std::span<const CodeSpan> sequences,
                                                               const ScoreBasis& basis,
                                                               const MatchSettings& settings,
                                                               const Monitor& monitor);

/// t_r as a mean z: that of the closest windows less `margin`.
double automatic_score_threshold(const ClosestWindows& closest, size_t window_length,
                                 double margin);

/// The basis for the sequences that are left when those whose `keep` is false have no codes. Rows
/// are still centred over what basis.bits counted.
ScoreBasis basis_of(const ScoreBasis& all, std::span<const CodeSpan> sequences,
                    const std::vector<uint8_t>& keep);

}  // namespace vpr
