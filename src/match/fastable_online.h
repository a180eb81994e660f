// FastABLE frame by frame: each new query frame yields one row of distances.
#pragma once

#include <cstddef>
#include <span>

#include "match/rows.h"

namespace vpr {

/// Whether the ring of window_length + 1 rows of distances fits the memory limit. Without it, the
/// outgoing distances are computed a second time.
bool ring_fits(size_t frame_count, size_t window_length, size_t memory_limit);

/// The stage for windows of these lengths, with each frame's distances computed once; with
/// settings.rates, the stage of rates.h. Memory: 8 bytes per train frame for sums, and the ring, 2
/// (c_l + 1) bytes per train frame; without the ring, outgoing distances are computed again.
/// Distances in order need the ring, because their outgoing distances cannot be recomputed: throws
/// Error(usage) if it does not fit the memory limit, or if a window of them is longer than
/// kMaxScoredWindow. Long databases are shared between threads.
WindowStage fastable_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                           const MatchSettings& settings);

}  // namespace vpr
