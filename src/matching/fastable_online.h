// FastABLE, frame by frame: one new query frame in, one row of distances out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "matching/rows.h"

namespace vpr {

/// Whether the ring of window_length + 1 rows of distances fits the memory limit. Without it, the
/// distances that leave the windows are computed a second time.
bool ring_fits(size_t frame_count, size_t window_length, size_t memory_limit);

/// What is kept between frames: 8 bytes a train frame for sums, and either the ring (2 * (c_l + 1)
/// bytes a train frame) or the codes of the last c_l query frames. Holds for one TrainCodes.
struct FastableState {
  size_t window_length = 0;
  size_t frames_seen = 0;
  bool has_ring = false;
  std::vector<uint32_t> sums;  ///< of windows ending at each train frame and the last query frame
  std::vector<uint32_t> next_sums;
  std::unique_ptr<uint16_t[]> ring;  ///< (window_length + 1) x frame stride; row f mod (c_l + 1)
  size_t ring_stride = 0;
  std::vector<CodeWords> recent;  ///< without a ring: query frame f at f mod window_length
};

FastableState start_fastable(const TrainCodes& train, const MatchSettings& settings);

/// Takes the next query frame. The result, valid until the next call, has one sum per train frame
/// i: D of the windows that end at i and at this frame. It means something only where both windows
/// lie within a run (emit_row and ends_window say where). Time O(frames); 1 Hamming distance a
/// train frame, 2 without a ring. Long databases are shared between threads.
std::span<const uint32_t> advance_fastable(FastableState& state, const TrainCodes& train,
                                           const HammingKernels& kernels, const CodeWords& frame);

/// Writes what enters the windows, for train frames [first, last) and the new query frame, to
/// out[0] and on; first is a multiple of kBlockFrames, and `out` has room for whole blocks. Called
/// once for every stretch of a row, from several threads at once.
using RowSource = std::function<void(size_t first, size_t last, uint16_t* out)>;

/// The same recurrence over values from elsewhere: sums of what entered in the last window_length
/// frames along the diagonals. Sums stay below 2^32. The state must have a ring.
std::span<const uint32_t> advance_sums(FastableState& state, size_t frame_count,
                                       const HammingKernels& kernels, const RowSource& source);

/// What entered with the last query frame, one value a train frame. The state must have a ring, and
/// have seen a frame.
const uint16_t* newest_row(const FastableState& state);

/// A whole query through advance_fastable, row after row.
void match_fastable_online(const TrainCodes& train, const QueryCodes& query,
                           const MatchSettings& settings, const Monitor& monitor,
                           const RowConsumer& consume);

}  // namespace vpr
