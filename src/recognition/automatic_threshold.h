// The automatic t_r of FastABLE: how close windows of different training sequences come.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "database/sequence_database.h"
#include "matching/rows.h"

namespace vpr {

/// For each training sequence the window of any other one that is closest to any of its own (paper,
/// section VII-D: two training sequences never show the same place, so whatever is as close as
/// they are is no recognition). Ties: smallest own window, then sequence, then window.
/// One entry a sequence, none where it, or every other, is shorter than a window.
std::vector<std::optional<ClosestWindows>> find_closest_windows(std::span<const CodeSpan> sequences,
                                                                const MatchSettings& settings,
                                                                const Monitor& monitor);

/// t_r in bits a frame: distance / window_length * safety_factor.
double automatic_threshold(const ClosestWindows& closest, size_t window_length,
                           double safety_factor);

/// One sentence for each pair of sequences that seem to show the same place: those whose distance
/// is below half the median of all, or below a tenth of the bits (with two
/// sequences, the median is their own distance). Frames are named by index: first and last of each
/// window.
std::vector<std::string> overlap_warnings(const ThresholdTable& table,
                                          std::span<const TrainSequence> sequences);

}  // namespace vpr
