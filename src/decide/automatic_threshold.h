// Automatic t_r, from how close windows of different places come.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "decide/score_kind.h"
#include "match/rows.h"
#include "store/sequence_database.h"

namespace vpr {

/// The mean distance of frames of one sequence that are no neighbors, in units of
/// frame_distances: that of compute_statistics for this sequence alone, with its default neighbors
/// and 1000 samples.
double typical_distance(const DescriptorSpan& sequence, const Monitor& monitor);

/// The largest automatic t_r, as a mean frame distance: (1 - 0.65 /
/// sqrt(c_l)) of the sequence's typical distance. Where training sequences look different, their
/// closest windows tell nothing.
double largest_threshold(double typical_distance, size_t window_length);

/// Of one of several sequences: the closest windows' distance / window_length, or
/// largest_threshold where that is smaller or there are none; times safety_factor.
AutomaticThreshold automatic_threshold(const std::optional<ClosestWindows>& closest,
                                       double typical_distance, size_t window_length,
                                       double safety_factor);

/// One entry a training sequence; none where it has no such windows.
using ClosestTable = std::vector<std::optional<ClosestWindows>>;

/// For each training sequence the window of any other one that is closest to any of its own (paper,
/// section VII-D: two training sequences never show the same place, so whatever is as close as
/// they are is no recognition). Ties: smallest own window, then sequence, then window. None for a
/// single sequence.
ClosestTable find_closest_windows(std::span<const DescriptorSpan> sequences,
                                  const MatchSettings& settings, const Monitor& monitor);

}  // namespace vpr
