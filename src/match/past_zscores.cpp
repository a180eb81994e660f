#include <algorithm>
#include <cassert>
#include <limits>
#include <memory>

#include "match/distance_statistics.h"
#include "match/match.h"
#include "match/zscores.h"

namespace vpr {
namespace {

/// Columns that have learned the same number of keyframes: those up to `end` after the previous
/// entry.
struct EqualWeights {
  size_t end = 0;
  double weight = 0;
};

struct PastState {
  FrameDistances distances;
  ScoreKernels kernels;
  size_t least_lag = 0;
  std::vector<uint8_t> readable;
  std::vector<float> mean;      ///< of columns
  std::vector<float> variance;  ///< of columns
  std::vector<float> offsets;   ///< of readable rows with a past
  std::vector<uint16_t> row;
  std::vector<uint16_t> scores;
  std::vector<EqualWeights> weights;
  KeyframeQueue keyframes;
  size_t started = 0;  ///< columns with fixed initial values
  size_t frame = 0;
  size_t rows = 0;  ///< readable ones with a past
  double sum_of_means = 0;
  uint64_t pairs = 0;
  double squares = 0;  ///< of x, over all pairs
  float least_variance = 0;
  double unknown_variance = 0;
};

// Computes the distances of a frame to the first `count` frames.
void compare(PastState& state, size_t frame, size_t count) {
  const auto query = static_cast<uint32_t>(frame);
  for_each_chunk(count, [&](size_t first, size_t last) {
    state.distances.tile({&query, 1}, first, last, state.row.data() + first, 0);
  });
}

// Adds a row to the statistics: r, R and V, its offset, and the initial values of its frame as a
// column.
void add_row(PastState& state, size_t frame) {
  if (state.readable[frame] == 0) return;
  uint64_t count = 0;
  uint64_t sum = 0;
  uint64_t squares = 0;
  for (const FrameStretch& run : state.distances.train_runs) {
    const size_t end = std::min<size_t>(run.first + run.count, state.distances.past[frame]);
    for (size_t i = run.first; i < end; ++i) {
      const uint64_t distance = state.row[i];
      sum += distance;
      squares += distance * distance;
      ++count;
    }
  }
  if (count == 0) return;
  const double row_mean = static_cast<double>(sum) / static_cast<double>(count);
  ++state.rows;
  state.sum_of_means += row_mean;
  state.pairs += count;
  state.squares += static_cast<double>(squares) - static_cast<double>(sum) * row_mean;
  const double mean_so_far = state.sum_of_means / static_cast<double>(state.rows);
  state.offsets[frame] = static_cast<float>(row_mean);
  state.mean[frame] = static_cast<float>(kStartBias * (row_mean - mean_so_far));
  state.keyframes.least_change = kKeyframeChange * mean_so_far;
}

double variance_so_far(const PastState& state) {
  return (kStartWeight * state.unknown_variance + state.squares) /
         (kStartWeight + static_cast<double>(state.pairs));
}

// The columns in the keyframe's past have learned one more keyframe; merges entries with equal
// weights.
void raise_weights(PastState& state, size_t past) {
  std::vector<EqualWeights>& weights = state.weights;
  if (weights.empty() || weights.back().end < past) weights.push_back({past, kStartWeight});
  for (EqualWeights& columns : weights) columns.weight = kForgetting * columns.weight + 1;
  size_t kept = 0;
  for (size_t w = 1; w < weights.size(); ++w) {
    if (weights[kept].weight != weights[w].weight) ++kept;
    weights[kept] = weights[w];
  }
  weights.resize(kept + 1);
}

void learn_keyframe(PastState& state, size_t keyframe) {
  const size_t past = state.distances.past[keyframe];
  raise_weights(state, past);
  compare(state, keyframe, past);
  size_t first = 0;
  for (const EqualWeights& columns : state.weights) {
    const auto gain = static_cast<float>(1 / columns.weight);
    state.kernels.learn(state.row.data() + first, state.offsets[keyframe], {}, gain,
                        state.mean.data() + first, state.variance.data() + first,
                        columns.end - first);
    first = columns.end;
  }
}

void begin_row(PastState& state, size_t frame) {
  state.frame = frame;
  const size_t past = state.distances.past[frame];
  const size_t compared = frame < state.least_lag ? 0 : frame + 1 - state.least_lag;
  if (state.readable[frame] != 0 && state.rows > 0 &&
      is_new_keyframe(state.keyframes, state.distances.query.rows, frame))
    if (const auto old = push_keyframe(state.keyframes, frame)) learn_keyframe(state, *old);
  compare(state, frame, compared);
  add_row(state, frame);
  std::fill(state.variance.begin() + ptrdiff_t(state.started),
            state.variance.begin() + ptrdiff_t(compared),
            static_cast<float>(variance_so_far(state)));
  state.started = past;
  for_each_chunk(compared, [&](size_t first, size_t last) {
    state.kernels.to_zscores(state.row.data() + first, state.offsets[frame], {},
                             state.mean.data() + first, state.variance.data() + first,
                             state.least_variance, state.scores.data() + first, last - first);
  });
}

std::shared_ptr<PastState> start_past(FrameDistances distances) {
  auto state = std::make_shared<PastState>();
  const size_t frames = distances.query_frames;
  state->kernels = select_score_kernels();
  state->least_lag = *least_lag(distances);
  state->readable = readable_flags(distances.query_runs, frames);
  state->mean.resize(frames, 0);
  state->variance.resize(frames, 0);
  state->offsets.resize(frames, 0);
  state->row.resize(frames + kBlockFrames);
  state->scores.resize(frames + kBlockFrames);
  state->keyframes = make_keyframe_queue(0);
  const double floor = deviation_floor(distances.largest);
  const double unknown = unknown_deviation(distances.largest);
  state->unknown_variance = unknown * unknown;
  state->least_variance = static_cast<float>(floor * floor);
  state->distances = std::move(distances);
  return state;
}

}  // namespace

FrameDistances past_zscores(FrameDistances distances) {
  assert(distances.past.size() == distances.query_frames && !distances.is_in_order());
  const auto state = start_past(std::move(distances));
  FrameDistances scores = state->distances;
  scores.largest = std::numeric_limits<uint16_t>::max();
  scores.row_total = nullptr;
  scores.of_query = nullptr;
  scores.start_row = [state](size_t query) { begin_row(*state, query); };
  scores.tile = [state]([[maybe_unused]] std::span<const uint32_t> queries, size_t first,
                        size_t last, uint16_t* out, size_t) {
    assert(queries.size() == 1 && queries.front() == state->frame);
    std::copy(state->scores.data() + first, state->scores.data() + last, out);
  };
  return scores;
}

}  // namespace vpr
