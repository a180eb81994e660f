#include "match/zscores.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "match/distance_statistics.h"

namespace vpr {
namespace {

constexpr size_t kChunkFrames = 2048;  // descriptors of a chunk stay in the second-level cache
constexpr size_t kRowStride = kChunkFrames + 32;  // rows must not share cache sets

using Distances = std::array<uint16_t, 2 * kRowStride>;

double center_of(ZScoreState& state, size_t frame) {
  if (!state.settings.center) return state.typical_distance;
  if (state.distances.row_total || state.distances.readable_frames == 0)
    return row_mean(state.distances, frame);
  compute_row(state.distances, frame, state.row);
  return static_cast<double>(row_sum(state.distances, state.row)) /
         static_cast<double>(state.distances.readable_frames);
}

void find_terms(ZScoreState& state, size_t frame) {
  FrameTerms& terms = state.terms[frame];
  terms.offset = static_cast<float>(center_of(state, frame));
  if (state.project)
    terms.common = common_weights(state.components, state.settings.components,
                                  state.project(state.distances.query.rows[frame]));
}

// The common part of a query frame and the training frames from `first` on.
CommonPart common_part(const ZScoreState& state, size_t frame, size_t first) {
  if (!state.project) return {};
  CommonPart common{
      {}, state.terms[frame].common, static_cast<float>(common_unit(state.components.shape))};
  for (size_t k = 0; k < kMaxComponents; ++k)
    common.loadings[k] = state.components.loadings[k].data() + first;
  return common;
}

// The weights of the previous statistics and of the new keyframe, and the share of the new one in
// the sum.
void plan_update(ZScoreState& state, size_t view) {
  state.weight = state.forgetting * state.weight + 1;
  state.start_weight *= state.forgetting;
  state.update = {view, static_cast<float>(1 / state.weight)};
}

void learn_chunk(ZScoreState& state, const uint16_t* distances, size_t first, size_t count) {
  state.kernels.learn(distances, state.terms[state.update->view].offset,
                      common_part(state, state.update->view, first), state.update->gain,
                      state.mean.data() + first, state.variance.data() + first, count);
}

void learn_everywhere(ZScoreState& state) {
  const size_t frames = state.distances.train_frames;
  const auto view = static_cast<uint32_t>(state.update->view);
  parallel_for((frames + kChunkFrames - 1) / kChunkFrames, {}, [&](size_t chunk) {
    Distances distances;
    const size_t first = chunk * kChunkFrames;
    const size_t count = std::min(kChunkFrames, frames - first);
    state.distances.tile({&view, 1}, first, first + count, distances.data(), kRowStride);
    learn_chunk(state, distances.data(), first, count);
  });
}

void learn_query(ZScoreState& state, const Monitor& monitor) {
  const DescriptorRows& rows = state.distances.query.rows;
  StepCounter counter(monitor, "learn", rows.size());
  for (const FrameRun& run : state.distances.query_runs) {
    for (size_t f = run.first; f < run.first + run.count; ++f) {
      counter.add();
      if (!is_new_view(state.views, rows, f)) continue;
      push_view(state.views, f);
      find_terms(state, f);
      plan_update(state, f);
      learn_everywhere(state);
    }
  }
  state.update.reset();
}

// A keyframe has been added; reuses the row of the learned one, if any.
void keep_row(ZScoreState& state) {
  if (state.rows.size() < state.views.pending.size())
    state.rows.emplace_back(state.distances.train_frames);
  else
    std::rotate(state.rows.begin(), state.rows.begin() + 1, state.rows.end());
}

// Determines what is learned before the frame is scored.
void begin_frame(ZScoreState& state, size_t frame) {
  state.frame = frame;
  state.row.clear();
  find_terms(state, frame);
  state.update.reset();
  state.keeps_row = false;
  if (state.offline || !state.settings.learn || state.readable[frame] == 0) return;
  if (!is_new_view(state.views, state.distances.query.rows, frame)) return;
  if (const auto view = push_view(state.views, frame)) plan_update(state, *view);
  state.keeps_row = state.views.lag <= kMostKeptRows;
  if (state.keeps_row) keep_row(state);
}

// Writes the distances of the frame, and applies the update to these training frames.
void learn_and_compare(ZScoreState& state, size_t first, size_t count, Distances& distances) {
  const std::array<uint32_t, 2> queries = {
      static_cast<uint32_t>(state.frame),
      static_cast<uint32_t>(state.update ? state.update->view : 0)};
  std::span<const uint32_t> asked(queries.data(), state.update && !state.keeps_row ? 2 : 1);
  uint16_t* out = distances.data();
  if (!state.row.empty()) {
    std::copy_n(state.row.data() + first, count, out);
    asked = asked.subspan(1);
    out += kRowStride;
  }
  if (!asked.empty()) state.distances.tile(asked, first, first + count, out, kRowStride);
  uint16_t* kept = state.keeps_row ? state.rows.back().data() + first : nullptr;
  if (state.update)
    learn_chunk(state, kept != nullptr ? kept : distances.data() + kRowStride, first, count);
  if (kept != nullptr) std::copy_n(distances.data(), count, kept);
}

double deviation_of(const ZScoreState& state, double variance) {
  return std::sqrt(std::clamp<double>(variance, state.least_variance, state.most_variance));
}

ScoreScale scale_of(const ZScoreState& state, size_t frame) {
  return {state.mean[frame], deviation_of(state, state.variance[frame])};
}

// Replaces the initial part of the accumulated sums by one with a small weight.
ScoreScale learned_scale(const ZScoreState& state, size_t frame) {
  const double start = state.start_mean[frame];
  const double start_square = state.start_variance + start * start;
  const double mean = state.mean[frame];
  const double added = state.light_weight - state.start_weight;
  const double weight = state.weight + added;
  if (weight <= 0) return scale_of(state, frame);
  const double light_mean = (state.weight * mean + added * start) / weight;
  const double light_square =
      (state.weight * (state.variance[frame] + mean * mean) + added * start_square) / weight;
  return {light_mean, deviation_of(state, light_square - light_mean * light_mean)};
}

void score_frames(ZScoreState& state, size_t first, size_t last, uint16_t* out) {
  assert(first % kStretchFrames == 0);
  Distances distances;
  for (size_t chunk = first; chunk < last; chunk += kChunkFrames) {
    const size_t count = std::min(kChunkFrames, last - chunk);
    learn_and_compare(state, chunk, count, distances);
    state.kernels.to_zscores(distances.data(), state.terms[state.frame].offset,
                             common_part(state, state.frame, chunk), state.mean.data() + chunk,
                             state.variance.data() + chunk, state.least_variance,
                             state.most_variance, out + (chunk - first), count);
  }
}

}  // namespace

std::shared_ptr<ZScoreState> start_zscores(FrameDistances distances, const ScoreBasis& basis,
                                           const Monitor& monitor) {
  assert(basis.mean.size() == distances.train_frames && !distances.is_in_order());
  const ZScoreSettings& settings = basis.settings;
  auto state = std::make_shared<ZScoreState>();
  state->settings = settings;
  state->offline = basis.offline;
  state->typical_distance = basis.typical_distance;
  state->mean = basis.mean;
  state->variance.assign(basis.mean.size(), basis.variance);
  state->components = basis.components;
  if (settings.components > 0 && !basis.components.landmarks.empty())
    state->project = make_projector(basis.components);
  state->terms.resize(distances.query_frames);
  state->views = make_view_queue(settings, basis.typical_distance);
  state->readable = readable_flags(distances.query_runs, distances.query_frames);
  state->kernels = select_score_kernels();
  const auto floor = static_cast<float>(deviation_floor(settings, distances.largest));
  const auto unknown = static_cast<float>(unknown_deviation(distances.largest));
  state->least_variance = settings.divide ? floor * floor : unknown * unknown;
  state->most_variance = settings.divide ? std::numeric_limits<float>::max() : unknown * unknown;
  state->forgetting = basis.offline ? 1 : settings.forgetting;
  state->weight = basis.offline ? settings.offline_start_weight : settings.start_weight;
  state->start_mean = basis.mean;
  state->start_variance = basis.variance;
  state->start_weight = state->weight;
  state->light_weight = settings.offline_start_weight;
  state->distances = std::move(distances);
  if (basis.offline && settings.learn) learn_query(*state, monitor);
  return state;
}

FrameDistances zscores(const std::shared_ptr<ZScoreState>& state) {
  FrameDistances scores = state->distances;
  scores.largest = std::numeric_limits<uint16_t>::max();
  scores.unit = {"standard deviations", 1.0 / kScoreUnit};
  scores.typical_distance = state->typical_distance;
  scores.row_total = nullptr;
  scores.of_query = nullptr;
  scores.scale = [state](size_t frame) { return scale_of(*state, frame); };
  scores.learned_scale = [state](size_t frame) { return learned_scale(*state, frame); };
  scores.start_row = [state](size_t query) { begin_frame(*state, query); };
  scores.tile = [state](std::span<const uint32_t> queries, size_t first, size_t last, uint16_t* out,
                        size_t) {
    assert(queries.size() == 1 && queries.front() == state->frame);
    score_frames(*state, first, last, out);
  };
  return scores;
}

FrameDistances zscores(FrameDistances distances, const ScoreBasis& basis, const Monitor& monitor) {
  return fused(zscores(start_zscores(std::move(distances), basis, monitor)), basis.fusion);
}

}  // namespace vpr
