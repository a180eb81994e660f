// FastABLE, frame by frame: one new query frame in, one row of distances out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "match/rows.h"

namespace vpr {

/// Whether the ring of window_length + 1 rows of distances fits the memory limit. Without it, the
/// distances that leave the windows are computed a second time.
bool ring_fits(size_t frame_count, size_t window_length, size_t memory_limit);

/// What is kept between frames: 8 bytes a train frame for sums, and either the ring (2 * (c_l + 1)
/// bytes a train frame) or which the last c_l query frames were. Holds for one FrameDistances.
struct FastableState {
  size_t window_length = 0;
  size_t frames_seen = 0;
  std::optional<size_t> least_lag;  ///< of a walk against itself (rows.h)
  bool has_ring = false;
  std::vector<uint32_t> sums;  ///< of windows ending at each train frame and the last query frame
  std::vector<uint32_t> next_sums;
  std::unique_ptr<uint16_t[]> ring;  ///< (window_length + 1) x frame stride; row f mod (c_l + 1)
  size_t ring_stride = 0;
  std::vector<uint32_t> recent;  ///< without a ring: the f-th query frame at f mod window_length
};

/// Distances that come in order need the ring, for what leaves a window is what entered it, and is
/// not known any more: throws Error(usage) if it does not fit the memory limit, or if a window is
/// longer than kMaxScoredWindow.
FastableState start_fastable(const FrameDistances& distances, const MatchSettings& settings);

/// Takes the next query frame. The result, valid until the next call, has one sum per train frame
/// i: D of the windows that end at i and at this frame. It means something only where both windows
/// lie within a run (emit_row and ends_window say where). Time O(frames); 1 frame distance a train
/// frame, 2 without a ring, for which the last c_l frames must still be there. Long databases are
/// shared between threads.
std::span<const uint32_t> advance_fastable(FastableState& state, const FrameDistances& distances,
                                           const RowKernels& kernels, size_t query_frame);

/// The stage for windows of these lengths, of which each frame's distances are computed once; where
/// settings.rates are given, that of rates.h. Throws what start_fastable throws.
WindowStage fastable_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                           const MatchSettings& settings);

}  // namespace vpr
