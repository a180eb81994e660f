#include "evaluation/counts.h"

#include <algorithm>
#include <cassert>
#include <set>

#include "evaluation/outcomes.h"

namespace vpr {
namespace {

void count(LabelCounts& counts, PlaceLabel label) {
  switch (label) {
    case PlaceLabel::same:
      ++counts.correct;
      return;
    case PlaceLabel::different:
      ++counts.incorrect;
      return;
    case PlaceLabel::ignore:
      ++counts.ignored;
      return;
  }
}

}  // namespace

bool shows_unreadable(const SequenceResult& result, size_t window) {
  const auto& frames = result.query_unreadable;
  const auto found = std::lower_bound(frames.begin(), frames.end(), window);
  return found != frames.end() && *found <= result.anchor(window);
}

std::optional<double> BestMatchCounts::rate() const {
  if (queries == ignored) return std::nullopt;
  return static_cast<double>(correct) / static_cast<double>(queries - ignored);
}

GroundTruthScope scope_of(const FabmapResult& result) {
  return {result.query_frames, {{"places", result.places.size(), true}}};
}

FabmapCounts count_recognitions(const FabmapResult& result, const GroundTruth& truth) {
  FabmapCounts counts;
  std::set<uint32_t> recognised;
  for (const PlaceMatch& hit : result.hits) {
    const PlaceLabel label = truth.label(hit.frame, 0, hit.place);
    count(counts.hits, label);
    if (label == PlaceLabel::same) recognised.insert(hit.place);
  }
  counts.distinct = recognised.size();
  counts.best_match = best_match_counts(outcomes_of(result, truth));
  return counts;
}

GroundTruthScope scope_of(const SequenceResult& result) {
  GroundTruthScope scope;
  scope.query_frames = result.query_frames;
  for (const SequenceThreshold& sequence : result.sequences)
    scope.sequences.push_back({sequence.name, sequence.frames, sequence.searched});
  return scope;
}

std::vector<JudgedPlace> judge_places(const SequenceResult& result, const GroundTruth& truth,
                                      const Monitor& monitor) {
  assert(result.place_of.size() == result.hits.size());
  const auto label_of = [&](const auto& pair) {
    return truth.label(result.anchor(pair.query_window), pair.sequence,
                       result.anchor(pair.train_window));
  };
  std::vector<JudgedPlace> judged;
  for (const Recognition& place : result.places) judged.push_back({label_of(place), {}});
  for (size_t h = 0; h < result.hits.size(); ++h) {
    check_stop(monitor);
    count(judged[result.place_of[h]].hits, label_of(result.hits[h]));
  }
  return judged;
}

SequenceCounts count_recognitions(const SequenceResult& result, const GroundTruth& truth,
                                  const Monitor& monitor) {
  SequenceCounts counts;
  for (const JudgedPlace& place : judge_places(result, truth, monitor)) {
    counts.hits.correct += place.hits.correct;
    counts.hits.incorrect += place.hits.incorrect;
    counts.hits.ignored += place.hits.ignored;
    count(counts.places, place.label);
    if (place.is_mixed()) ++counts.mixed_places;
  }
  counts.distinct = counts.places.correct;
  counts.best_match = best_match_counts(outcomes_of(result, truth));
  return counts;
}

}  // namespace vpr
