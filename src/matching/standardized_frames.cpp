#include "matching/standardized_frames.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include "base/parallel.h"
#include "matching/distance_statistics.h"

namespace vpr {
namespace {

constexpr size_t kChunkFrames = 2048;             // codes of a chunk stay in the second-level cache
constexpr size_t kRowStride = kChunkFrames + 32;  // rows must not share cache sets

using Distances = std::array<uint16_t, 2 * kRowStride>;

// The weights of what was known and of the new view, and the share of the new one in the sum.
void teach(StandardizedState& state, const ScoreBasis& basis, const CodeWords& view) {
  state.weight = state.forgetting * state.weight + 1;
  state.lesson = {view, row_offset(basis, view), static_cast<float>(1 / state.weight)};
}

void learn_chunk(StandardizedState& state, const uint16_t* distances, size_t first, size_t count) {
  state.kernels.learn(distances, state.lesson->offset, state.lesson->gain,
                      state.mean.data() + first, state.variance.data() + first, count);
}

void learn_everywhere(StandardizedState& state, const TrainCodes& train,
                      const HammingKernels& kernels) {
  parallel_for((train.frame_count + kChunkFrames - 1) / kChunkFrames, {}, [&](size_t chunk) {
    Distances distances;
    const size_t first = chunk * kChunkFrames;
    const size_t count = std::min(kChunkFrames, train.frame_count - first);
    kernels.row_distances(state.lesson->view, train.blocks.data() + first / kBlockFrames,
                          (count + kBlockFrames - 1) / kBlockFrames, distances.data());
    learn_chunk(state, distances.data(), first, count);
  });
}

void learn_query(StandardizedState& state, const TrainCodes& train, const QueryCodes& query,
                 const ScoreBasis& basis, const HammingKernels& kernels, const Monitor& monitor) {
  StepCounter counter(monitor, "learn", query.words.size());
  for (const FrameRun& run : query.runs) {
    for (size_t f = run.first; f < run.first + run.count; ++f) {
      counter.add();
      if (!is_new_view(state.views, query.words[f])) continue;
      push_view(state.views, query.words[f]);
      teach(state, basis, query.words[f]);
      learn_everywhere(state, train, kernels);
    }
  }
  state.lesson.reset();
}

}  // namespace

StandardizedState start_standardized(const TrainCodes& train, const QueryCodes& query,
                                     const ScoreBasis& basis, const HammingKernels& kernels,
                                     const Monitor& monitor) {
  assert(basis.bias.size() == train.frame_count && basis.variance.size() == train.frame_count);
  const StandardizationSettings& settings = basis.settings;
  StandardizedState state;
  state.mean = basis.bias;
  state.variance = basis.variance;
  state.views = make_view_queue(basis);
  state.kernels = select_score_kernels();
  const auto floor = static_cast<float>(settings.deviation_floor);
  constexpr auto kUnknown = static_cast<float>(kUnknownDeviation);
  state.least_variance = settings.divide ? floor * floor : kUnknown * kUnknown;
  state.most_variance = settings.divide ? std::numeric_limits<float>::max() : kUnknown * kUnknown;
  state.forgetting = basis.offline ? 1 : settings.forgetting;
  state.weight = basis.offline ? settings.offline_start_weight : settings.start_weight;
  if (basis.offline && settings.learn) learn_query(state, train, query, basis, kernels, monitor);
  return state;
}

void begin_frame(StandardizedState& state, const ScoreBasis& basis, const CodeWords& frame,
                 bool is_readable) {
  state.frame = frame;
  state.offset = row_offset(basis, frame);
  state.lesson.reset();
  if (basis.offline || !basis.settings.learn || !is_readable) return;
  if (!is_new_view(state.views, frame)) return;
  if (const auto view = push_view(state.views, frame)) teach(state, basis, *view);
}

void score_frames(StandardizedState& state, const TrainCodes& train, const HammingKernels& kernels,
                  size_t first, size_t last, uint16_t* out) {
  assert(first % kBlockFrames == 0);
  Distances distances;
  for (size_t chunk = first; chunk < last; chunk += kChunkFrames) {
    const size_t count = std::min(kChunkFrames, last - chunk);
    const CodeBlock* blocks = train.blocks.data() + chunk / kBlockFrames;
    const size_t block_count = (count + kBlockFrames - 1) / kBlockFrames;
    if (state.lesson) {
      const std::array<CodeWords, 2> words = {state.frame, state.lesson->view};
      kernels.tile_distances(words.data(), 2, blocks, block_count, distances.data(), kRowStride);
      learn_chunk(state, distances.data() + kRowStride, chunk, count);
    } else {
      kernels.row_distances(state.frame, blocks, block_count, distances.data());
    }
    state.kernels.standardize(distances.data(), state.offset, state.mean.data() + chunk,
                              state.variance.data() + chunk, state.least_variance,
                              state.most_variance, out + (chunk - first), count);
  }
}

std::vector<uint8_t> readable_frames(const QueryCodes& query) {
  std::vector<uint8_t> readable(query.words.size(), 0);
  for (const FrameRun& run : query.runs)
    std::fill_n(readable.begin() + static_cast<ptrdiff_t>(run.first), run.count, uint8_t{1});
  return readable;
}

}  // namespace vpr
