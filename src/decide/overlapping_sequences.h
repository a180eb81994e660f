// The detection of training sequences that show the same place.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "base/monitor.h"
#include "match/frame_distances.h"
#include "match/row_kernels.h"

namespace vpr {

/// Pairs (a, b), a < b, increasing, of sequences that show the same place at least in part: one of
/// the two is a query of the other, and at least a tenth of its windows are recognized. Windows are
/// 20 frames of z-scores (or half of the shorter sequence, but at least 4), recognized by the
/// default margin. `radii`: the exclusion radius of every sequence. Longer sequences are compared
/// in evenly spread parts of 1000 frames, at least two per sequence, with at most most_pairs frame
/// pairs in total. Throws Error(interrupted) on a stop.
std::vector<std::pair<size_t, size_t>> find_overlapping_sequences(
    std::span<const DescribedFrames> sequences, const std::vector<uint32_t>& radii,
    const RowKernels& kernels, const Monitor& monitor, size_t most_pairs = size_t{1} << 32);

}  // namespace vpr
