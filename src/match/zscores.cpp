#include "match/zscores.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>

namespace vpr {
namespace {

constexpr size_t kChunkFrames = 2048;  // descriptors of a chunk stay in the second-level cache

// The mean over the training frames that is subtracted from the row of a frame. Keeps the row if it
// had to be computed.
double center_of(ZScoreState& state, size_t frame) {
  if (state.distances.row_total || state.distances.readable_frames == 0)
    return row_mean(state.distances, frame);
  compute_row(state.distances, frame, state.row);
  return static_cast<double>(row_sum(state.distances, state.row)) /
         static_cast<double>(state.distances.readable_frames);
}

void find_terms(ZScoreState& state, size_t frame) {
  state.terms[frame].offset = static_cast<float>(center_of(state, frame));
  if (state.project)
    state.terms[frame].common =
        component_weights(state.basis.components, state.project(state.distances.query.rows[frame]));
}

// The common part of a query frame and the training frames from `first` on.
ComponentTerm component_term(const ZScoreState& state, size_t frame, size_t first) {
  if (!state.project) return {};
  ComponentTerm common{{},
                       state.terms[frame].common,
                       static_cast<float>(component_unit(state.basis.components.shape))};
  for (size_t k = 0; k < kMaxComponents; ++k)
    common.loadings[k] = state.basis.components.loadings[k].data() + first;
  return common;
}

// Determines the weight with which a keyframe will enter the statistics.
void plan_update(ZScoreState& state, size_t keyframe) {
  state.weight = kForgetting * state.weight + 1;
  state.update = {keyframe, static_cast<float>(1 / state.weight)};
}

void learn_chunk(ZScoreState& state, const uint16_t* distances, size_t first, size_t count) {
  state.kernels.learn(distances, state.terms[state.update->keyframe].offset,
                      component_term(state, state.update->keyframe, first), state.update->gain,
                      state.mean.data() + first, state.variance.data() + first, count);
}

// Determines what is learned before the frame is scored.
void begin_frame(ZScoreState& state, size_t frame) {
  state.frame = frame;
  if (state.distances.start_row) state.distances.start_row(frame);
  state.row.clear();
  find_terms(state, frame);
  state.update.reset();
  state.is_keyframe = state.readable[frame] != 0 &&
                      is_new_keyframe(state.keyframes, state.distances.query.rows, frame);
  if (!state.is_keyframe) return;
  if (const auto old = push_keyframe(state.keyframes, frame)) plan_update(state, *old);
  if (state.rows.size() < state.keyframes.pending.size())
    state.rows.emplace_back(state.distances.train_frames);
  else  // reuses the row of the old keyframe
    std::rotate(state.rows.begin(), state.rows.begin() + 1, state.rows.end());
}

void score_frames(ZScoreState& state, size_t first, size_t last, uint16_t* out) {
  assert(first % kBlockFrames == 0);
  const auto query = static_cast<uint32_t>(state.frame);
  std::array<uint16_t, kChunkFrames> computed;
  for (size_t chunk = first; chunk < last; chunk += kChunkFrames) {
    const size_t count = std::min(kChunkFrames, last - chunk);
    const uint16_t* row = state.row.empty() ? computed.data() : state.row.data() + chunk;
    if (state.row.empty())
      state.distances.tile({&query, 1}, chunk, chunk + count, computed.data(), 0);
    if (state.is_keyframe) {
      uint16_t* kept = state.rows.back().data() + chunk;
      if (state.update) learn_chunk(state, kept, chunk, count);
      std::copy_n(row, count, kept);
    }
    state.kernels.to_zscores(row, state.terms[state.frame].offset,
                             component_term(state, state.frame, chunk), state.mean.data() + chunk,
                             state.variance.data() + chunk, state.least_variance,
                             out + (chunk - first), count);
  }
}

}  // namespace

ScoreBasis make_score_basis(const TrainStatistics& statistics, double start_weight) {
  ScoreBasis basis{start_weight, statistics.typical_distance, {}, 0, {}};
  basis.components = statistics.components.value_or(no_components(statistics.bias.size()));
  ComponentValues of_bias = {};
  for (size_t l = 0; l < basis.components.landmarks.size(); ++l)
    for (size_t k = 0; k < kMaxComponents; ++k)
      of_bias[k] += kStartBias * statistics.bias[basis.components.landmarks[l]] *
                    basis.components.weights[l][k];
  const ComponentWeights weights = component_weights(basis.components, of_bias);
  const double unit = component_unit(basis.components.shape);
  for (size_t i = 0; i < statistics.bias.size(); ++i)
    basis.mean.push_back(static_cast<float>(kStartBias * statistics.bias[i] -
                                            unit * component_sum(basis.components, weights, i)));
  const double sum =
      std::accumulate(statistics.variance.begin(), statistics.variance.end(), double{0});
  const double frames = std::max<double>(1, static_cast<double>(statistics.variance.size()));
  basis.variance = static_cast<float>(sum / frames);
  return basis;
}

KeyframeQueue make_keyframe_queue(double typical_distance) {
  return {kKeyframeChange * typical_distance};
}

bool is_new_keyframe(const KeyframeQueue& queue, const DescriptorRows& rows, size_t frame) {
  return std::all_of(queue.pending.begin(), queue.pending.end(), [&](size_t keyframe) {
    return frame_distance(rows, keyframe, frame) >= queue.least_change;
  });
}

std::optional<size_t> push_keyframe(KeyframeQueue& queue, size_t keyframe) {
  queue.pending.push_back(keyframe);
  if (queue.pending.size() <= kKeyframeLag) return std::nullopt;
  const size_t oldest = queue.pending.front();
  queue.pending.erase(queue.pending.begin());
  return oldest;
}

std::vector<uint32_t> keyframe_starts(const DescribedFrames& sequence, double typical_distance) {
  KeyframeQueue queue = make_keyframe_queue(typical_distance);
  std::vector<uint32_t> starts;
  for (size_t frame = 0; frame < sequence.rows.size(); ++frame) {
    const auto& gaps = sequence.unreadable;
    const bool is_readable = !std::binary_search(gaps.begin(), gaps.end(), frame);
    const bool is_new = is_readable && is_new_keyframe(queue, sequence.rows, frame);
    if (is_new) push_keyframe(queue, frame);
    if (is_new || frame == 0) starts.push_back(static_cast<uint32_t>(frame));
  }
  return starts;
}

std::shared_ptr<ZScoreState> start_zscores(FrameDistances distances, const ScoreBasis& basis) {
  assert(basis.mean.size() == distances.train_frames);
  auto state = std::make_shared<ZScoreState>();
  state->basis = basis;
  state->mean = basis.mean;
  state->variance.assign(basis.mean.size(), basis.variance);
  state->weight = basis.start_weight;
  if (!basis.components.landmarks.empty()) state->project = make_projector(basis.components);
  state->terms.resize(distances.query_frames);
  state->keyframes = make_keyframe_queue(basis.typical_distance);
  state->readable = readable_flags(distances.query_runs, distances.query_frames);
  state->kernels = select_score_kernels();
  const auto floor = static_cast<float>(deviation_floor(distances.largest));
  state->least_variance = floor * floor;
  state->distances = std::move(distances);
  return state;
}

FrameDistances zscores(const std::shared_ptr<ZScoreState>& state) {
  FrameDistances scores = state->distances;
  scores.largest = std::numeric_limits<uint16_t>::max();
  scores.typical_distance = state->basis.typical_distance;
  scores.row_total = nullptr;
  scores.of_query = nullptr;
  scores.start_row = [state](size_t query) { begin_frame(*state, query); };
  scores.tile = [state]([[maybe_unused]] std::span<const uint32_t> queries, size_t first,
                        size_t last, uint16_t* out, size_t) {
    assert(queries.size() == 1 && queries.front() == state->frame);
    score_frames(*state, first, last, out);
  };
  return scores;
}

FrameDistances zscores(FrameDistances distances, const ScoreBasis& basis) {
  return zscores(start_zscores(std::move(distances), basis));
}

void continue_zscores(ZScoreState& state, FrameDistances part, std::span<const size_t> kept) {
  std::vector<FrameTerms> terms;
  for (const size_t frame : kept) terms.push_back(state.terms[frame]);
  terms.resize(part.query_frames);
  state.terms = std::move(terms);
  for (size_t& frame : state.keyframes.pending)
    frame = static_cast<size_t>(std::ranges::lower_bound(kept, frame) - kept.begin());
  state.readable = readable_flags(part.query_runs, part.query_frames);
  state.distances = std::move(part);
}

}  // namespace vpr
