// Resources, results and words for tests of queries and evaluations.
#pragma once

#include "base/random.h"
#include "fabmap/vocabulary.h"
#include "query/plan.h"
#include "query/result.h"
#include "query/run_query.h"
#include "truth/ground_truth.h"

namespace vpr::test {

/// Windows of this length by a threshold, automatic without a number.
inline SequenceQuerySettings by_threshold(uint64_t length,
                                          std::optional<double> threshold = std::nullopt) {
  return {Threshold{{.window_length = length}, threshold}};
}

/// Windows of this length by a margin, the default one without a number.
inline SequenceQuerySettings by_margin(uint64_t length,
                                       std::optional<double> margin = std::nullopt) {
  return {Margin{{.window_length = length}, margin}};
}

inline Result query_result(const SequenceDatabase& database, const DescriptorSet& query,
                           const SequenceQuerySettings& settings) {
  return run_query(plan_query(prepare(database, settings), query, "q", settings, {}, {}), {}, {})
      .result;
}

/// A result of one training sequence, "ref", without matches.
inline Result make_result(size_t query_frames, size_t window_length, size_t train_frames) {
  Result result;
  result.settings = by_threshold(window_length);
  result.query.frames = query_frames;
  result.query_windows = query_frames - window_length + 1;
  result.sequences = {{{"ref", train_frames},
                       train_frames - window_length + 1,
                       true,
                       0.5,
                       ThresholdScale::relative,
                       10,
                       100}};
  return result;
}

/// The first `matched` of the query frames show the training frame of the same number.
inline GroundTruth aligned_truth(size_t query_frames, size_t matched) {
  GroundTruth truth;
  truth.pairs.resize(query_frames);
  for (uint32_t frame = 0; frame < matched; ++frame)
    truth.pairs[frame].push_back({0, frame, PlaceLabel::same});
  return truth;
}

/// Each word with a chance of 1 / share.
inline WordSet random_words(size_t words, uint64_t share, RandomEngine& engine) {
  WordSet set;
  for (uint32_t q = 0; q < words; ++q)
    if (uniform_below(engine, share) == 0) set.push_back(q);
  return set;
}

}  // namespace vpr::test
