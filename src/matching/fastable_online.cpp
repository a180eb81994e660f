#include "matching/fastable_online.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"

namespace vpr {
namespace {

constexpr size_t kChunkFrames = 2048;       // codes of a chunk stay in the second-level cache
constexpr size_t kFramesPerThread = 32768;  // below, a second thread costs more than it gives

size_t padded(size_t frame_count) {
  return (frame_count + kBlockFrames - 1) / kBlockFrames * kBlockFrames;
}

void distances_of_frames(const HammingKernels& kernels, const TrainCodes& train,
                         const CodeWords& query, size_t first, size_t last, uint16_t* out) {
  assert(first % kBlockFrames == 0);
  const size_t blocks = (last - first + kBlockFrames - 1) / kBlockFrames;
  kernels.row_distances(query, train.blocks.data() + first / kBlockFrames, blocks, out);
}

// next[i] = sums[i - 1] + entering[i - first] - leaving[i - first] for i in [first, last).
void slide_frames(FastableState& state, const HammingKernels& kernels, size_t first, size_t last,
                  const uint16_t* entering, const uint16_t* leaving) {
  if (first >= last) return;
  if (first == 0) {  // nothing comes in from the left
    state.next_sums[0] = entering[0];
    ++first;
    ++entering;
    ++leaving;
  }
  kernels.slide(state.sums.data() + first - 1, entering, leaving, state.next_sums.data() + first,
                last - first);
}

// The leaving term of window end i is the distance of train frame i - c_l to query frame f - c_l,
// which the ring has kept; there is none where either index is negative.
void advance_with_ring(FastableState& state, const HammingKernels& kernels, const RowSource& source,
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

// Without a ring the same pass over the codes gives both distances: those of the frame that leaves
// are needed window_length train frames later, and wait in a delay line.
void advance_without_ring(FastableState& state, const TrainCodes& train,
                          const HammingKernels& kernels, const CodeWords& frame, size_t begin,
                          size_t end) {
  const size_t length = state.window_length;
  const bool leaves = state.frames_seen >= length;
  const CodeWords old = state.recent[state.frames_seen % length];
  // A part that does not start at 0 first fills its delay line.
  const size_t history =
      leaves ? std::min(begin, (length + kBlockFrames - 1) / kBlockFrames * kBlockFrames) : 0;
  std::vector<uint16_t> entering(kChunkFrames);
  // delay[x] belongs to train frame delay_first + x.
  std::vector<uint16_t> delay(length + kBlockFrames + kChunkFrames, 0);
  const size_t keep = length + kBlockFrames;  // entries kept in front of a chunk
  if (history > 0)
    distances_of_frames(kernels, train, old, begin - history, begin,
                        delay.data() + (keep - history));
  for (size_t first = begin; first < end; first += kChunkFrames) {
    const size_t last = std::min(first + kChunkFrames, end);
    distances_of_frames(kernels, train, frame, first, last, entering.data());
    // Train frames before 0 have no distance: the delay line starts with zeros.
    if (leaves) distances_of_frames(kernels, train, old, first, last, delay.data() + keep);
    slide_frames(state, kernels, first, last, entering.data(), delay.data() + (keep - length));
    std::copy(delay.end() - static_cast<ptrdiff_t>(keep), delay.end(), delay.begin());
  }
}

// Long databases are shared between threads. `advance` takes train frames [begin, end).
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

}  // namespace

bool ring_fits(size_t frame_count, size_t window_length, size_t memory_limit) {
  size_t bytes = 0;
  return !__builtin_mul_overflow(padded(frame_count) * sizeof(uint16_t), window_length + 1,
                                 &bytes) &&
         bytes <= memory_limit;
}

FastableState start_fastable(const TrainCodes& train, const MatchSettings& settings) {
  assert(settings.window_length >= 1 && settings.window_length <= kMaxWindowLength);
  FastableState state;
  state.window_length = settings.window_length;
  state.has_ring = ring_fits(train.frame_count, settings.window_length, settings.memory_limit);
  state.sums.assign(train.frame_count, 0);
  state.next_sums.assign(train.frame_count, 0);
  if (state.has_ring) {
    state.ring_stride = padded(train.frame_count);
    state.ring =
        std::make_unique_for_overwrite<uint16_t[]>(state.ring_stride * (state.window_length + 1));
  } else {
    state.recent.resize(state.window_length);
  }
  return state;
}

std::span<const uint32_t> advance_sums(FastableState& state, size_t frame_count,
                                       const HammingKernels& kernels, const RowSource& source) {
  assert(state.has_ring && state.sums.size() == frame_count);
  return advance_in_parts(state, frame_count, [&](size_t begin, size_t end) {
    advance_with_ring(state, kernels, source, begin, end);
  });
}

const uint16_t* newest_row(const FastableState& state) {
  assert(state.has_ring && state.frames_seen > 0);
  return state.ring.get() + (state.frames_seen - 1) % (state.window_length + 1) * state.ring_stride;
}

std::span<const uint32_t> advance_fastable(FastableState& state, const TrainCodes& train,
                                           const HammingKernels& kernels, const CodeWords& frame) {
  if (state.has_ring)
    return advance_sums(state, train.frame_count, kernels,
                        [&](size_t first, size_t last, uint16_t* out) {
                          distances_of_frames(kernels, train, frame, first, last, out);
                        });
  const size_t seen = state.frames_seen;
  const auto sums = advance_in_parts(state, train.frame_count, [&](size_t begin, size_t end) {
    advance_without_ring(state, train, kernels, frame, begin, end);
  });
  state.recent[seen % state.window_length] = frame;
  return sums;
}

void match_fastable_online(const TrainCodes& train, const QueryCodes& query,
                           const MatchSettings& settings, const Monitor& monitor,
                           const RowConsumer& consume) {
  if (!any_window_pair(train, query, settings.window_length)) return;
  FastableState state = start_fastable(train, settings);
  StepCounter counter(monitor, "match", query.words.size());
  for (size_t frame = 0; frame < query.words.size(); ++frame) {
    const auto sums = advance_fastable(state, train, settings.kernels, query.words[frame]);
    if (ends_window(query, settings.window_length, frame))
      emit_row(train, settings.window_length, frame, 0, sums, consume);
    counter.add();
  }
}

}  // namespace vpr
