// FastABLE: sums of distances over windows, each from the previous sum on its diagonal (paper,
// section VII); frame by frame, or for a whole query at once.
#pragma once

#include <cstddef>
#include <span>

#include "match/match.h"

namespace vpr {

/// Whether the ring of window_length + 1 rows of distances fits the memory limit.
bool ring_fits(size_t train_frames, size_t window_length, size_t memory_limit);

/// The stage for windows of these lengths. Distances of each frame are computed once and kept in a
/// ring of 2 (c_l + 1) bytes per training frame for the longest c_l; sums take 8 bytes per training
/// frame and length. Without room for the ring, outgoing distances are computed a second time.
/// Threads share long databases.
///
/// Distances in order need the ring: throws Error(usage) if it does not fit the memory limit, or if
/// a window is longer than kMaxScoredWindow.
WindowStage fastable_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                           const MatchSettings& settings);

/// The whole query at once, for searches without margins (maxima, sweeps of thresholds): up to
/// twice as fast as frame by frame. Strips of diagonals (train frame - query frame) are
/// independent: their running sums stay in place, and each strip has a ring of the longest window
/// length in its thread's cache. Strips are narrow enough for the memory limit, but at least 64
/// diagonals wide. Any tile of `distances` must be computable at any time; at least one of the two
/// sequences has a window.
void match_strips(const FrameDistances& distances, std::span<const size_t> window_lengths,
                  const MatchSettings& settings, const Monitor& monitor,
                  const LengthRowConsumer& consume);

}  // namespace vpr
