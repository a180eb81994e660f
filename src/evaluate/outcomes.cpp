#include "evaluate/outcomes.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "base/statistics.h"
#include "evaluate/metrics.h"

namespace vpr {
namespace {

void count(KeyframeCounts& counts, const LabelCounts& labels) {
  ++(labels.correct + labels.incorrect == 0 ? counts.ignored
     : labels.incorrect == 0                ? counts.correct
     : labels.correct == 0                  ? counts.incorrect
                                            : counts.mixed);
}

// The keyframe of a frame; the first one is frame 0.
size_t keyframe_of(const std::vector<uint32_t>& keyframes, size_t frame) {
  return static_cast<size_t>(std::ranges::upper_bound(keyframes, frame) - keyframes.begin()) - 1;
}

// One entry per query keyframe.
Outcomes outcomes_by_keyframe(const Result& result, Outcomes outcomes, const GroundTruth& truth) {
  const auto& [query_keyframes, train_keyframes] = *result.keyframes;
  std::vector<QueryOutcome> found(query_keyframes.size());
  const auto key_of = [&](const QueryOutcome& query) {
    return confidence_key(query, outcomes.confidence);
  };
  for (const QueryOutcome& query : outcomes.queries) {
    QueryOutcome& one = found[keyframe_of(query_keyframes, query.frame)];
    const bool has_match = one.has_match || query.has_match;
    if (query.verdict != Verdict::ignored && key_of(query) < key_of(one)) one = query;
    one.has_match = has_match;
  }
  for (QueryOutcome& one : found) {
    if (one.verdict != Verdict::incorrect) continue;
    const std::vector<uint32_t>& starts = train_keyframes[one.best->sequence];
    const size_t keyframe = keyframe_of(starts, one.best->reference);
    const size_t end = keyframe + 1 < starts.size()
                           ? starts[keyframe + 1]
                           : result.sequences[one.best->sequence].sequence.frames;
    for (const LabelStretch& run : label_runs(truth, one.frame, one.best->sequence, end))
      if (run.label == PlaceLabel::same && run.last >= starts[keyframe])
        one.verdict = Verdict::correct;
  }
  outcomes.queries = std::move(found);
  return outcomes;
}

}  // namespace

Verdict verdict_of(PlaceLabel label) {
  return label == PlaceLabel::same        ? Verdict::correct
         : label == PlaceLabel::different ? Verdict::incorrect
                                          : Verdict::ignored;
}

Outcomes unanswered(const GroundTruth& truth, size_t query_frames, size_t window_length,
                    ScoreOrder kind) {
  Outcomes outcomes{.kind = kind, .window_length = window_length, .queries = {}};
  outcomes.queries.resize(query_frames);
  for (size_t frame = 0; frame < query_frames; ++frame) {
    outcomes.queries[frame].frame = frame;
    outcomes.queries[frame].has_match = truth.has_match(frame);
  }
  return outcomes;
}

Outcomes outcomes_of(const Result& result, const GroundTruth& truth) {
  const size_t length = result.window_length();
  Outcomes outcomes = unanswered(truth, result.query.frames, length, result.score().order);
  for (size_t window = 0; window < result.best.size(); ++window) {
    const auto& best = result.best[window];
    if (!best) continue;
    QueryOutcome& query = outcomes.at_window(window);
    query.best = anchors_of(*best, length).match;
    query.key = score_key(best->score, outcomes.kind);
    query.verdict = verdict_of(label_of(truth, *best, length));
  }
  add_margins(outcomes, result);
  return outcomes;
}

void add_margins(Outcomes& outcomes, const Result& result) {
  outcomes.has_margins = !result.margins.empty();
  const auto* settings = std::get_if<SequenceQuerySettings>(&result.settings);
  if (outcomes.has_margins && settings != nullptr &&
      decision_of(settings->rule) == Decision::margin)
    outcomes.confidence = Confidence::margin;
  for (size_t window = 0; window < result.margins.size(); ++window) {
    QueryOutcome& query = outcomes.at_window(window);
    const auto& best = result.best[window];
    if (!best || query.best != anchors_of(*best, result.window_length()).match) continue;
    query.margin = frame_margin(result, window);
    query.required_margin = result.sequences[best->sequence].margin;
  }
}

uint64_t frames_with_match(const Outcomes& outcomes) {
  return static_cast<uint64_t>(
      std::ranges::count(outcomes.queries, true, &QueryOutcome::has_match));
}

bool is_judged(const QueryOutcome& query) {
  return query.verdict == Verdict::correct || query.verdict == Verdict::incorrect;
}

uint64_t confidence_key(const QueryOutcome& query, Confidence by) {
  if (by == Confidence::score) return query.key;
  return query.margin ? score_key(*query.margin, ScoreOrder::similarity) : kNoScore;
}

ScoreOrder confidence_order(const Outcomes& outcomes) {
  return outcomes.confidence == Confidence::score ? outcomes.kind : ScoreOrder::similarity;
}

std::optional<double> BestMatchCounts::rate() const { return share_of(correct, frames); }

BestMatchCounts best_match_counts(const Outcomes& outcomes) {
  BestMatchCounts counts;
  for (const QueryOutcome& query : outcomes.queries) {
    if (!query.has_match) {
      ++counts.without_match;
      continue;
    }
    ++counts.frames;
    ++(query.verdict == Verdict::correct     ? counts.correct
       : query.verdict == Verdict::incorrect ? counts.incorrect
       : query.verdict == Verdict::ignored   ? counts.ignored
                                             : counts.no_answer);
  }
  return counts;
}

void LabelCounts::add(PlaceLabel label, uint64_t pairs) {
  (label == PlaceLabel::same        ? correct
   : label == PlaceLabel::different ? incorrect
                                    : ignored) += pairs;
}

PlaceLabel label_of(const GroundTruth& truth, const MatchedFrame& matched) {
  return truth.label(matched.query, matched.match.sequence, matched.match.reference);
}

PlaceLabel label_of(const GroundTruth& truth, const Match& match, size_t window_length) {
  return label_of(truth, anchors_of(match, window_length));
}

PlaceLabel label_of(const GroundTruth& truth, const Cluster& cluster, size_t window_length) {
  return truth.label(anchor_of(cluster.query_window, window_length), cluster.sequence,
                     anchor_of(cluster.train_window, window_length));
}

Clusters clusters_of(const Result& result) {
  if (result.clusters) return *result.clusters;
  Clusters single;
  for (const Match& recognition : result.recognitions) {
    single.of_recognition.push_back(static_cast<uint32_t>(single.all.size()));
    single.all.push_back({recognition.sequence, recognition.query, recognition.query,
                          recognition.query, recognition.train, recognition.train,
                          recognition.train, 1, recognition.score});
  }
  return single;
}

std::vector<JudgedCluster> judge_clusters(const Result& result, const GroundTruth& truth,
                                          const Monitor& monitor) {
  const Clusters clusters = clusters_of(result);
  const size_t length = result.window_length();
  std::vector<JudgedCluster> judged;
  for (const Cluster& cluster : clusters.all)
    judged.push_back({label_of(truth, cluster, length), {}});
  for (size_t r = 0; r < result.recognitions.size(); ++r) {
    check_stop(monitor);
    judged[clusters.of_recognition[r]].recognitions.add(
        label_of(truth, result.recognitions[r], length));
  }
  return judged;
}

void count_clusters(Counts& counts, const std::vector<JudgedCluster>& clusters) {
  counts.clusters.emplace();
  counts.recognitions_by_place.emplace();
  counts.mixed_clusters = 0;
  for (const JudgedCluster& cluster : clusters) {
    counts.clusters->add(cluster.label);
    counts.recognitions_by_place->add(cluster.label, cluster.recognitions.all());
    *counts.mixed_clusters += cluster.is_mixed();
  }
  counts.distinct = counts.clusters->correct;
}

Counts count_recognitions(const Result& result, const GroundTruth& truth, const Monitor& monitor) {
  Counts counts;
  std::set<std::pair<uint32_t, uint32_t>> places;  // recognized correctly: sequence and window
  for (const Match& recognition : result.recognitions) {
    check_stop(monitor);
    const PlaceLabel label = label_of(truth, recognition, result.window_length());
    counts.recognitions.add(label);
    if (!result.clusters && label == PlaceLabel::same)
      places.insert({recognition.sequence, recognition.train});
  }
  counts.distinct = places.size();
  if (result.clusters) count_clusters(counts, judge_clusters(result, truth, monitor));
  return counts;
}

std::optional<CountsByKeyframe> count_by_keyframe(const Result& result, const GroundTruth& truth,
                                                  const Outcomes& outcomes,
                                                  const Monitor& monitor) {
  if (!result.keyframes) return std::nullopt;
  const auto& [query_keyframes, train_keyframes] = *result.keyframes;
  const size_t length = result.window_length();
  CountsByKeyframe counts;
  counts.query_keyframes = query_keyframes.size();
  for (size_t s = 0; s < result.sequences.size(); ++s)
    if (result.sequences[s].searched) counts.train_keyframes += train_keyframes[s].size();
  std::map<std::tuple<size_t, uint32_t, size_t>, LabelCounts> pairs;
  for (const Match& recognition : result.recognitions) {
    check_stop(monitor);
    const auto [frame, match] = anchors_of(recognition, length);
    pairs[{keyframe_of(query_keyframes, frame), match.sequence,
           keyframe_of(train_keyframes[match.sequence], match.reference)}]
        .add(label_of(truth, recognition, length));
  }
  for (const auto& [pair, labels] : pairs) count(counts.recognitions, labels);
  std::map<size_t, LabelCounts> queries;
  for (const QueryOutcome& query : outcomes.queries) {
    if (!query.has_match) continue;
    LabelCounts& labels = queries[keyframe_of(query_keyframes, query.frame)];
    ++(query.verdict == Verdict::correct   ? labels.correct
       : query.verdict == Verdict::ignored ? labels.ignored
                                           : labels.incorrect);
  }
  double sum = 0;
  for (const auto& [query, labels] : queries) {
    count(counts.best_match, labels);
    const uint64_t judged = labels.correct + labels.incorrect;
    if (judged > 0) sum += static_cast<double>(labels.correct) / static_cast<double>(judged);
  }
  const KeyframeCounts& best = counts.best_match;
  counts.best_match_rate = share_of(sum, best.correct + best.incorrect + best.mixed);
  const Outcomes by_keyframe = outcomes_by_keyframe(result, outcomes, truth);
  counts.recall_at_full_precision = recall_at_full_precision(single_best_curve(by_keyframe)).value;
  return counts;
}

}  // namespace vpr
