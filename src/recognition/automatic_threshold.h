// The automatic t_r of FastABLE: how close windows of different places come.
#pragma once

#include <span>
#include <vector>

#include "database/sequence_database.h"
#include "matching/rows.h"
#include "recognition/threshold.h"

namespace vpr {

using ClosestTable = std::vector<std::optional<ClosestWindows>>;

/// Keeps the candidate if it is closer. Ties: smallest own window, then sequence, then window.
void keep_closer(std::optional<ClosestWindows>& kept, const ClosestWindows& candidate);

/// For each training sequence the window of any other one that is closest to any of its own (paper,
/// section VII-D: two training sequences never show the same place, so whatever is as close as
/// they are is no recognition). Ties: smallest own window, then sequence, then window. Of a single
/// sequence: closest_elsewhere. One entry a sequence, none where there are no such windows.
std::vector<std::optional<ClosestWindows>> find_closest_windows(
    std::span<const DescriptorSpan> sequences, const MatchSettings& settings,
    const Monitor& monitor);

/// Of a single training sequence, on the scale mean: how close its own windows elsewhere come
/// (closest_elsewhere) as a share of its typical distance, but at most 1 - 0.8 / sqrt(c_l), which
/// it also is where there are none; times safety_factor.
AutomaticThreshold own_threshold(const std::optional<ClosestWindows>& closest,
                                 double typical_distance, size_t window_length,
                                 double safety_factor);

/// The mean distance of frames of one sequence that are no neighbours, in units of
/// frame_distances: that of compute_statistics for this sequence alone, with its default neighbours
/// and 1000 samples.
double typical_distance(const DescriptorSpan& sequence, const Monitor& monitor);

/// What no automatic t_r of several sequences is above, in bits a frame: (1 - 0.65 / sqrt(c_l)) of
/// the sequence's typical distance. Where training sequences look different, their closest windows
/// tell nothing.
double largest_threshold(double typical_distance, size_t window_length);

/// In bits a frame: the closest windows' distance / window_length, or largest_threshold where that
/// is smaller or there are none; times safety_factor.
AutomaticThreshold automatic_threshold(const std::optional<ClosestWindows>& closest,
                                       double typical_distance, size_t window_length,
                                       double safety_factor);

}  // namespace vpr
