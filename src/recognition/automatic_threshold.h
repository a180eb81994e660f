// Automatic t_r, from how close windows of different places come.
#pragma once

#include <optional>

#include "base/monitor.h"
#include "database/sequence_database.h"
#include "recognition/threshold.h"

namespace vpr {

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

/// What no automatic t_r of several sequences is above, as a mean frame distance: (1 - 0.65 /
/// sqrt(c_l)) of the sequence's typical distance. Where training sequences look different, their
/// closest windows tell nothing.
double largest_threshold(double typical_distance, size_t window_length);

/// Of several sequences, on the scale bits: the closest windows' distance / window_length, or
/// largest_threshold where that is smaller or there are none; times safety_factor.
AutomaticThreshold automatic_threshold(const std::optional<ClosestWindows>& closest,
                                       double typical_distance, size_t window_length,
                                       double safety_factor);

/// What no automatic t_r is above, as a mean z: -5.5 / sqrt(c_l).
double largest_score_threshold(size_t window_length);

/// t_r as a mean z: that of the closest windows, or largest_score_threshold where that is smaller
/// or there are none; less `margin`.
AutomaticThreshold automatic_score_threshold(const std::optional<ClosestWindows>& closest,
                                             size_t window_length, double margin);

}  // namespace vpr
