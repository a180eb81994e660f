#include "match/fastable_online.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "match/rates.h"
#include "match/zscore_model.h"

namespace vpr {
namespace {

constexpr size_t kChunkFrames = 2048;       // descriptors of a chunk stay in the second-level cache
constexpr size_t kFramesPerThread = 32768;  // below this, a second thread costs more than it saves

/// The state between frames: 8 bytes per train frame for sums, and either the ring (2 * (c_l + 1)
/// bytes per train frame) or the indices of the last c_l query frames. Valid for one
/// FrameDistances.
struct FastableState {
  size_t window_length = 0;
  size_t frames_seen = 0;
  std::optional<size_t> least_lag;  ///< for a sequence against itself (rows.h)
  bool has_ring = false;
  std::vector<uint32_t> sums;  ///< of windows ending at each train frame and the last query frame
  std::vector<uint32_t> next_sums;
  std::unique_ptr<uint16_t[]> ring;  ///< (window_length + 1) x frame stride; row f mod (c_l + 1)
  size_t ring_stride = 0;
  std::vector<uint32_t> recent;  ///< without a ring: the f-th query frame at f mod window_length
};

/// Writes the distances that enter the windows, of train frames [first, last) and the new query
/// frame, to out[0] and on, as FrameDistances::tile does.
using RowSource = std::function<void(size_t first, size_t last, uint16_t* out)>;

size_t padded(size_t frame_count) {
  return (frame_count + kStretchFrames - 1) / kStretchFrames * kStretchFrames;
}

RowSource row_of(const FrameDistances& distances, uint32_t query) {
  return [&distances, query](size_t first, size_t last, uint16_t* out) {
    distances.tile({&query, 1}, first, last, out, 0);
  };
}

// next[i] = sums[i - 1] + entering[i - first] - leaving[i - first] for i in [first, last).
void slide_frames(FastableState& state, const RowKernels& kernels, size_t first, size_t last,
                  const uint16_t* entering, const uint16_t* leaving) {
  if (first >= last) return;
  if (first == 0) {  // no sum enters from the left
    state.next_sums[0] = entering[0];
    ++first;
    ++entering;
    ++leaving;
  }
  kernels.slide(state.sums.data() + first - 1, entering, leaving, state.next_sums.data() + first,
                last - first);
}

// The outgoing term of window end i is the distance of train frame i - c_l to query frame f - c_l,
// which the ring has kept; there is none if either index is negative.
void advance_with_ring(FastableState& state, const RowKernels& kernels, const RowSource& source,
                       size_t begin, size_t end) {
  const size_t rows = state.window_length + 1;
  uint16_t* entering = state.ring.get() + state.frames_seen % rows * state.ring_stride;
  const uint16_t* old = state.ring.get() + (state.frames_seen + 1) % rows * state.ring_stride;
  const bool leaves = state.frames_seen >= state.window_length;
  const std::vector<uint16_t> zeros(std::min(kChunkFrames, end - begin), 0);
  for (size_t first = begin; first < end; first += kChunkFrames) {
    const size_t last = std::min(first + kChunkFrames, end);
    source(first, last, entering + first);
    const size_t split = leaves ? std::clamp(state.window_length, first, last) : last;
    slide_frames(state, kernels, first, split, entering + first, zeros.data());
    if (split < last)
      slide_frames(state, kernels, split, last, entering + split,
                   old + split - state.window_length);
  }
}

// Without a ring, one pass over the descriptors computes both distances: those of the outgoing
// frame are needed window_length train frames later, and wait in a delay line.
void advance_without_ring(FastableState& state, const FrameDistances& distances,
                          const RowKernels& kernels, uint32_t frame, size_t begin, size_t end) {
  const size_t length = state.window_length;
  const bool leaves = state.frames_seen >= length;
  const RowSource entering_row = row_of(distances, frame);
  const RowSource leaving_row = row_of(distances, state.recent[state.frames_seen % length]);
  // A part that does not start at 0 first fills its delay line.
  const size_t history = leaves ? std::min(begin, padded(length)) : 0;
  std::vector<uint16_t> entering(kChunkFrames);
  // delay[x] belongs to train frame delay_first + x.
  std::vector<uint16_t> delay(length + kStretchFrames + kChunkFrames, 0);
  const size_t keep = length + kStretchFrames;  // entries kept before a chunk
  if (history > 0) leaving_row(begin - history, begin, delay.data() + (keep - history));
  for (size_t first = begin; first < end; first += kChunkFrames) {
    const size_t last = std::min(first + kChunkFrames, end);
    entering_row(first, last, entering.data());
    // Train frames before 0 have no distance: the delay line starts with zeros.
    if (leaves) leaving_row(first, last, delay.data() + keep);
    slide_frames(state, kernels, first, last, entering.data(), delay.data() + (keep - length));
    std::copy(delay.end() - static_cast<ptrdiff_t>(keep), delay.end(), delay.begin());
  }
}

// Long databases are shared between threads. `advance` processes train frames [begin, end).
template <class Advance>
std::span<const uint32_t> advance_in_parts(FastableState& state, size_t frames,
                                           const Advance& advance) {
  const size_t parts = std::clamp<size_t>(frames / kFramesPerThread, 1, thread_count());
  if (parts == 1) {
    advance(0, frames);
  } else {
    const size_t part = padded((frames + parts - 1) / parts);
    parallel_for(parts, Monitor{}, [&](size_t p) {
      advance(std::min(p * part, frames), std::min((p + 1) * part, frames));
    });
  }
  std::swap(state.sums, state.next_sums);
  ++state.frames_seen;
  return state.sums;
}

// The number of train frames to compare with the next query frame: for a sequence against itself,
// those that it, or a later frame on their diagonal, may match.
size_t compared_frames(const FastableState& state) {
  if (!state.least_lag) return state.sums.size();
  return state.frames_seen < *state.least_lag ? 0 : state.frames_seen + 1 - *state.least_lag;
}

// Requires that the row has been started (FrameDistances::start_row).
std::span<const uint32_t> advance_sums(FastableState& state, const RowKernels& kernels,
                                       const RowSource& source) {
  assert(state.has_ring);
  return advance_in_parts(state, compared_frames(state), [&](size_t begin, size_t end) {
    advance_with_ring(state, kernels, source, begin, end);
  });
}

std::span<const uint32_t> advance_started(FastableState& state, const FrameDistances& distances,
                                          const RowKernels& kernels, uint32_t frame) {
  if (state.has_ring) return advance_sums(state, kernels, row_of(distances, frame));
  const size_t seen = state.frames_seen;
  const auto sums = advance_in_parts(state, compared_frames(state), [&](size_t begin, size_t end) {
    advance_without_ring(state, distances, kernels, frame, begin, end);
  });
  state.recent[seen % state.window_length] = frame;
  return sums;
}

// The distances that entered another state's ring with the last query frame.
RowSource copy_of(const FastableState& state) {
  const size_t row = (state.frames_seen - 1) % (state.window_length + 1);
  return
      [from = state.ring.get() + row * state.ring_stride](
          size_t first, size_t last, uint16_t* out) { std::copy(from + first, from + last, out); };
}

size_t ring_bytes(const FastableState& state) {
  return state.ring_stride * (state.window_length + 1) * sizeof(uint16_t);
}

void check_scored_ring(const FrameDistances& distances, const MatchSettings& settings) {
  if (settings.window_length > kMaxScoredWindow)
    throw Error(ErrorKind::usage, fmt::format("z-scores allow a c_l of at most {}, found {}",
                                              kMaxScoredWindow, settings.window_length));
  if (!ring_fits(distances.train_frames, settings.window_length, settings.memory_limit))
    throw Error(ErrorKind::usage,
                fmt::format("z-scores of {} training frames at c_l {} need {} MiB of memory in "
                            "addition to other c_l; raise --max-memory",
                            distances.train_frames, settings.window_length,
                            (distances.train_frames * (settings.window_length + 1) >> 19) + 1));
}

FastableState start_fastable(const FrameDistances& distances, const MatchSettings& settings) {
  assert(settings.window_length >= 1 && settings.window_length <= kMaxWindowLength);
  if (distances.is_in_order()) check_scored_ring(distances, settings);
  FastableState state;
  state.window_length = settings.window_length;
  state.least_lag = least_lag(distances);
  state.has_ring = ring_fits(distances.train_frames, settings.window_length, settings.memory_limit);
  state.sums.assign(distances.train_frames, 0);
  state.next_sums.assign(distances.train_frames, 0);
  if (state.has_ring) {
    state.ring_stride = padded(distances.train_frames);
    state.ring =
        std::make_unique_for_overwrite<uint16_t[]>(state.ring_stride * (state.window_length + 1));
  } else {
    state.recent.resize(state.window_length);
  }
  return state;
}

// Every length has its own sums, and the rings share the memory.
std::vector<FastableState> start_lengths(const FrameDistances& distances,
                                         std::span<const size_t> window_lengths,
                                         MatchSettings settings) {
  std::vector<FastableState> states;
  for (const size_t length : window_lengths) {
    settings.window_length = length;
    states.push_back(start_fastable(distances, settings));
    if (states.back().has_ring) settings.memory_limit -= ring_bytes(states.back());
  }
  return states;
}

}  // namespace

bool ring_fits(size_t frame_count, size_t window_length, size_t memory_limit) {
  size_t bytes = 0;
  return !__builtin_mul_overflow(padded(frame_count) * sizeof(uint16_t), window_length + 1,
                                 &bytes) &&
         bytes <= memory_limit;
}

WindowStage fastable_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                           const MatchSettings& settings) {
  if (!settings.rates.empty()) return rate_stage(distances, window_lengths, settings);
  const auto states = std::make_shared<std::vector<FastableState>>(
      start_lengths(distances, window_lengths, settings));
  return [states, kernels = settings.kernels](const FrameDistances& rows, const QueryFrame& frame,
                                              const StageConsumer& consume) {
    if (rows.start_row) rows.start_row(frame.row);
    const FastableState& first = states->front();
    for (size_t l = 0; l < states->size(); ++l) {
      FastableState& state = (*states)[l];
      const bool has_copy = l > 0 && first.has_ring && state.has_ring;
      const auto sums =
          has_copy ? advance_sums(state, kernels, copy_of(first))
                   : advance_started(state, rows, kernels, static_cast<uint32_t>(frame.row));
      if (frame.in_a_row < state.window_length) continue;
      const std::vector<ScoreRow> row = whole_row(rows, state.window_length, frame.number, sums);
      if (!row.empty()) consume(l, row);
    }
  };
}

}  // namespace vpr
