#include "match/fastable.h"

#include <algorithm>
#include <memory>
#include <optional>

#include <oneapi/tbb/cache_aligned_allocator.h>

#include "base/error.h"
#include "match/row_kernels.h"
#include "match/zscores.h"

namespace vpr {
namespace {

// The number of values in whole cache lines.
template <class T>
size_t in_lines(size_t values) {
  constexpr size_t kCacheLineBytes = 64;
  return round_up(values, kCacheLineBytes / sizeof(T));
}

/// Rows in a ring, zeros before they are written. Each has leading zeros for positions before the
/// first training frame, which is aligned to a cache line.
template <class T>
struct Ring {
  size_t rows = 0;
  size_t front = 0;
  size_t stride = 0;
  std::vector<T, oneapi::tbb::cache_aligned_allocator<T>> values;

  Ring(size_t row_count, size_t zeros, size_t frames)
      : rows(row_count),
        front(in_lines<T>(zeros)),
        stride(front + in_lines<T>(frames)),
        values(rows * stride, 0) {}
  /// The value of training frame `frame` in the row that was written `back` rows before row `row`.
  T* at(size_t row, size_t back, size_t frame) {
    return values.data() + (row + rows - back) % rows * stride + front + frame;
  }
};

/// Windows of one length.
struct WindowSums {
  size_t length = 0;
  Ring<uint32_t> sums;        ///< of windows that end at the last query frame and the next one
  Ring<uint16_t> recomputed;  ///< without a ring: the row of outgoing distances
};

/// The state between query frames. Valid for one FrameDistances.
struct FastableState {
  std::optional<size_t> least_lag;  ///< for a sequence against itself (match.h)
  bool has_ring = false;
  Ring<uint16_t> distances;      ///< of the last frames; without a ring: one row
  std::vector<uint32_t> recent;  ///< without a ring: the rows of the last query frames
  std::vector<WindowSums> sums;  ///< by length
};

size_t ring_bytes(size_t train_frames, size_t longest) {
  return sizeof(uint16_t) * (longest + 1) *
         (in_lines<uint16_t>(longest) + in_lines<uint16_t>(train_frames));
}

FastableState start_fastable(const FrameDistances& distances,
                             std::span<const size_t> window_lengths,
                             const MatchSettings& settings) {
  const size_t frames = distances.train_frames;
  const size_t longest = std::ranges::max(window_lengths);
  const size_t bytes = ring_bytes(frames, longest);
  const bool has_ring = bytes <= settings.memory_limit;
  if (distances.is_in_order()) {
    if (longest > kMaxScoredWindow)
      throw Error(ErrorKind::usage, "z-scores allow a c_l of at most {}, found {}",
                  kMaxScoredWindow, longest);
    if (!has_ring)
      throw Error(
          ErrorKind::usage,
          "windows over {} training frames at c_l {} need {} MiB of memory; raise --max-memory",
          frames, longest, (bytes >> 20) + 1);
  }
  FastableState state{least_lag(distances),
                      has_ring,
                      Ring<uint16_t>(has_ring ? longest + 1 : 1, longest, frames),
                      {},
                      {}};
  if (!has_ring) state.recent.resize(longest);
  for (const size_t length : window_lengths)
    state.sums.push_back(
        {length, Ring<uint32_t>(2, 1, frames), Ring<uint16_t>(has_ring ? 0 : 1, length, frames)});
  return state;
}

// S(j, i) for training frames [first, last) from S(j - 1, i - 1) and the incoming and outgoing
// distances. `frame`: j.
void slide(FastableState& state, WindowSums& of, size_t frame, size_t first, size_t last) {
  const uint16_t* outgoing =
      state.has_ring ? state.distances.at(frame, of.length, first) : of.recomputed.at(0, 0, first);
  slide_sums(of.sums.at(frame, 1, first) - 1, state.distances.at(frame, 0, first),
             outgoing - of.length, of.sums.at(frame, 0, first), last - first);
}

// Adds a query frame. For a sequence against itself, only training frames that it, or a later frame
// on their diagonal, may match are compared.
void advance(FastableState& state, const FrameDistances& distances, const QueryFrame& frame) {
  size_t compared = distances.train_frames;
  if (state.least_lag) compared = frame.number + 1 - std::min(*state.least_lag, frame.number + 1);
  const auto compare = [&](uint32_t query, size_t first, size_t last, uint16_t* out) {
    distances.tile({&query, 1}, first, last, out, 0);
  };
  if (distances.start_row) distances.start_row(frame.row);
  const auto slide_all = [&](size_t first, size_t last) {
    for (WindowSums& sums : state.sums) slide(state, sums, frame.number, first, last);
  };
  // Without a ring, the codes of a chunk are in the cache when outgoing frames are compared with
  // it.
  for_each_chunk(compared, [&](size_t first, size_t last) {
    compare(static_cast<uint32_t>(frame.row), first, last,
            state.distances.at(frame.number, 0, first));
    if (state.has_ring) return slide_all(first, last);
    for (WindowSums& sums : state.sums)
      if (frame.number >= sums.length)
        compare(state.recent[(frame.number - sums.length) % state.recent.size()], first, last,
                sums.recomputed.at(0, 0, first));
  });
  if (state.has_ring) return;
  for_each_chunk(compared, slide_all);  // reads outgoing distances of the chunk before
  state.recent[frame.number % state.recent.size()] = static_cast<uint32_t>(frame.row);
}

}  // namespace

bool ring_fits(size_t train_frames, size_t window_length, size_t memory_limit) {
  return ring_bytes(train_frames, window_length) <= memory_limit;
}

WindowStage fastable_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                           const MatchSettings& settings) {
  const auto state =
      std::make_shared<FastableState>(start_fastable(distances, window_lengths, settings));
  return
      [state](const FrameDistances& rows, const QueryFrame& frame, const StageConsumer& consume) {
        advance(*state, rows, frame);
        for (size_t l = 0; l < state->sums.size(); ++l) {
          WindowSums& windows = state->sums[l];
          if (frame.consecutive_readable < windows.length) continue;
          const std::vector<ScoreRow> row =
              whole_row(rows, windows.length, frame.number,
                        {windows.sums.at(frame.number, 0, 0), rows.train_frames});
          if (!row.empty()) consume(l, row);
        }
      };
}

}  // namespace vpr
