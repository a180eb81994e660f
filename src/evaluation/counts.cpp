#include "evaluation/counts.h"

#include <algorithm>
#include <cassert>
#include <set>

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

BestMatchCounts count_best_matches(const SequenceResult& result, const GroundTruth& truth) {
  BestMatchCounts counts;
  for (size_t window = 0; window < result.best.size(); ++window) {
    const auto& best = result.best[window];
    const size_t anchor = result.anchor(window);
    if (!best && shows_unreadable(result, window)) {
      ++counts.unreadable;
      continue;
    }
    if (!truth.has_match(anchor)) {
      ++counts.without_match;
      continue;
    }
    ++counts.queries;
    // An approximate method may find nothing at all, which is wrong.
    const PlaceLabel label =
        best ? truth.label(anchor, best->sequence, result.anchor(best->train_window))
             : PlaceLabel::different;
    if (label == PlaceLabel::same) ++counts.correct;
    if (label == PlaceLabel::ignore) ++counts.ignored;
  }
  return counts;
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
  const std::set<size_t> unreadable(result.query_unreadable.begin(), result.query_unreadable.end());
  for (size_t frame = 0; frame < result.best.size(); ++frame) {
    if (unreadable.contains(frame)) {
      ++counts.best_match.unreadable;
    } else if (!truth.has_match(frame)) {
      ++counts.best_match.without_match;
    } else {
      ++counts.best_match.queries;
      const auto& best = result.best[frame];
      const PlaceLabel label = best ? truth.label(frame, 0, best->place) : PlaceLabel::different;
      if (label == PlaceLabel::same) ++counts.best_match.correct;
      if (label == PlaceLabel::ignore) ++counts.best_match.ignored;
    }
  }
  return counts;
}

GroundTruthScope scope_of(const SequenceResult& result) {
  GroundTruthScope scope;
  scope.query_frames = result.query_frames;
  for (const SequenceThreshold& sequence : result.sequences)
    scope.sequences.push_back({sequence.name, sequence.frames, sequence.searched});
  return scope;
}

std::vector<JudgedPlace> judge_places(const SequenceResult& result, const GroundTruth& truth) {
  assert(result.place_of.size() == result.hits.size());
  const auto label_of = [&](const auto& pair) {
    return truth.label(result.anchor(pair.query_window), pair.sequence,
                       result.anchor(pair.train_window));
  };
  std::vector<JudgedPlace> judged;
  for (const Recognition& place : result.places) judged.push_back({label_of(place), {}});
  for (size_t h = 0; h < result.hits.size(); ++h)
    count(judged[result.place_of[h]].hits, label_of(result.hits[h]));
  return judged;
}

SequenceCounts count_recognitions(const SequenceResult& result, const GroundTruth& truth) {
  SequenceCounts counts;
  for (const JudgedPlace& place : judge_places(result, truth)) {
    counts.hits.correct += place.hits.correct;
    counts.hits.incorrect += place.hits.incorrect;
    counts.hits.ignored += place.hits.ignored;
    count(counts.places, place.label);
    if (place.is_mixed()) ++counts.mixed_places;
  }
  counts.distinct = counts.places.correct;
  counts.best_match = count_best_matches(result, truth);
  return counts;
}

}  // namespace vpr
