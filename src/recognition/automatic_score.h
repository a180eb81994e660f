// The automatic t_r of standardized scores: how close training sequences come to each other.
#pragma once

#include "database/sequence_database.h"
#include "matching/rows.h"
#include "matching/standardization.h"
#include "recognition/automatic_threshold.h"

namespace vpr {

/// Every training sequence is a query against all others, with the scores that a query would have:
/// for each sequence, the window of any other one that scores lowest against any of its own. Unlike
/// distances, scores are not the same in both directions, and those with the sequence as training
/// data count. Of a single sequence: closest_elsewhere, itself being the query.
/// ClosestWindows::distance is a biased sum (matching/score_kernels.h). `basis`: of all sequences
/// together. Ties: smallest own window, then sequence, then window. One entry a sequence, none
/// where there are no such windows. Throws what match_in_order throws.
std::vector<std::optional<ClosestWindows>> find_closest_scores(
    std::span<const DescriptorSpan> sequences, const ScoreBasis& basis,
    const MatchSettings& settings, const Monitor& monitor);

/// What no automatic t_r is above, as a mean z: -5.5 / sqrt(c_l).
double largest_score_threshold(size_t window_length);

/// t_r as a mean z: that of the closest windows, or largest_score_threshold where that is smaller
/// or there are none; less `margin`.
AutomaticThreshold automatic_score_threshold(const std::optional<ClosestWindows>& closest,
                                             size_t window_length, double margin);

/// The basis for the sequences that are left when those whose `keep` is false have no frames.
ScoreBasis basis_of(const ScoreBasis& all, std::span<const DescriptorSpan> sequences,
                    const std::vector<uint8_t>& keep);

}  // namespace vpr
