#include "matching/fastable_standardized.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"

namespace vpr {
namespace {

size_t ring_bytes(const FastableState& state) {
  return state.ring_stride * (state.window_length + 1) * sizeof(uint16_t);
}

// Every length has sums of its own, and the rings share the memory.
std::vector<FastableState> start_lengths(const TrainCodes& train,
                                         std::span<const size_t> window_lengths,
                                         MatchSettings settings) {
  std::vector<FastableState> states;
  for (const size_t length : window_lengths) {
    settings.window_length = length;
    states.push_back(start_scored_sums(train, settings));
    settings.memory_limit -= ring_bytes(states.back());
  }
  return states;
}

RowSource scoring_source(StandardizedState& frames, const TrainCodes& train,
                         const HammingKernels& kernels) {
  return [&](size_t first, size_t last, uint16_t* out) {
    score_frames(frames, train, kernels, first, last, out);
  };
}

// What another state's ring got for the same frame.
RowSource copying_source(const uint16_t* row) {
  return
      [row](size_t first, size_t last, uint16_t* out) { std::copy(row + first, row + last, out); };
}

}  // namespace

FastableState start_scored_sums(const TrainCodes& train, const MatchSettings& settings) {
  if (settings.window_length > kMaxScoredWindow)
    throw Error(ErrorKind::usage,
                fmt::format("standardized scores allow a c_l of {} at most, found {}",
                            kMaxScoredWindow, settings.window_length));
  if (!ring_fits(train.frame_count, settings.window_length, settings.memory_limit))
    throw Error(ErrorKind::usage,
                fmt::format("standardized scores of {} training frames at c_l {} need {} MiB of "
                            "memory beside what other c_l take; raise --max-memory",
                            train.frame_count, settings.window_length,
                            (train.frame_count * (settings.window_length + 1) >> 19) + 1));
  return start_fastable(train, settings);
}

std::span<const uint32_t> advance_scored(ScoredFastable& state, const TrainCodes& train,
                                         const HammingKernels& kernels) {
  return advance_sums(state.sums, train.frame_count, kernels,
                      scoring_source(state.frames, train, kernels));
}

void match_standardized(const TrainCodes& train, const QueryCodes& query,
                        std::span<const size_t> window_lengths, const ScoreBasis& basis,
                        const MatchSettings& settings, const Monitor& monitor,
                        const LengthRowConsumer& consume) {
  if (window_lengths.empty()) return;
  const size_t shortest = *std::min_element(window_lengths.begin(), window_lengths.end());
  if (!any_window_pair(train, query, shortest)) return;
  std::vector<FastableState> states = start_lengths(train, window_lengths, settings);
  StandardizedState frames = start_standardized(train, query, basis, settings.kernels, monitor);
  const std::vector<uint8_t> readable = readable_frames(query);
  StepCounter counter(monitor, "match", query.words.size());
  for (size_t frame = 0; frame < query.words.size(); ++frame) {
    check_stop(monitor);
    begin_frame(frames, basis, query.words[frame], readable[frame] != 0);
    for (size_t l = 0; l < states.size(); ++l) {
      const auto sums = advance_sums(states[l], train.frame_count, settings.kernels,
                                     l == 0 ? scoring_source(frames, train, settings.kernels)
                                            : copying_source(newest_row(states[0])));
      if (ends_window(query, window_lengths[l], frame))
        emit_row(train, window_lengths[l], frame, 0, sums,
                 [&](const DistanceRow& row) { consume(l, row); });
    }
    counter.add();
  }
}

}  // namespace vpr
