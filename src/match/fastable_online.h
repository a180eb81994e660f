// FastABLE, frame by frame: one new query frame in, one row of distances out.
#pragma once

#include <cstddef>
#include <span>

#include "match/rows.h"

namespace vpr {

/// Whether the ring of window_length + 1 rows of distances fits the memory limit. Without it, the
/// distances that leave the windows are computed a second time.
bool ring_fits(size_t frame_count, size_t window_length, size_t memory_limit);

/// The stage for windows of these lengths, of which each frame's distances are computed once; where
/// settings.rates are given, that of rates.h. Memory: 8 bytes a train frame for sums, and the ring,
/// 2 (c_l + 1) bytes a train frame; without the ring, distances that leave a window are computed
/// again. Distances that come in order need the ring, for what leaves a window is not known any
/// more: throws Error(usage) if it does not fit the memory limit, or if a window of them is longer
/// than kMaxScoredWindow. Long databases are shared between threads.
WindowStage fastable_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                           const MatchSettings& settings);

}  // namespace vpr
