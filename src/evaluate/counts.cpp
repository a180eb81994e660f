#include "evaluate/counts.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <set>
#include <utility>

#include "evaluate/outcomes.h"

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

void count_clusters(Counts& counts, const std::vector<JudgedCluster>& judged) {
  LabelCounts& clusters = counts.clusters.emplace();
  for (const JudgedCluster& cluster : judged) {
    counts.recognitions.correct += cluster.recognitions.correct;
    counts.recognitions.incorrect += cluster.recognitions.incorrect;
    counts.recognitions.ignored += cluster.recognitions.ignored;
    count(clusters, cluster.label);
    if (cluster.is_mixed()) ++counts.mixed_clusters;
  }
  counts.distinct = clusters.correct;
}

void count_recognitions(Counts& counts, const Result& result, const GroundTruth& truth) {
  std::set<std::pair<uint32_t, uint32_t>> recognized;
  for (const Match& recognition : result.recognitions) {
    const PlaceLabel label = label_of(truth, recognition, result.window_length());
    count(counts.recognitions, label);
    if (label == PlaceLabel::same) recognized.insert({recognition.target, recognition.train});
  }
  counts.distinct = recognized.size();
}

/// What the frames of one view, or one pair of views, are.
struct Tally {
  uint64_t correct = 0;
  uint64_t incorrect = 0;
};

void add(Tally& tally, PlaceLabel label) {
  if (label == PlaceLabel::same) ++tally.correct;
  if (label == PlaceLabel::different) ++tally.incorrect;
}

void count(ViewCounts& counts, const Tally& tally) {
  if (tally.correct + tally.incorrect == 0)
    ++counts.ignored;
  else if (tally.incorrect == 0)
    ++counts.correct;
  else if (tally.correct == 0)
    ++counts.incorrect;
  else
    ++counts.mixed;
}

// The view that a frame belongs to. The first view starts at the first frame.
size_t view_of(const std::vector<uint32_t>& starts, size_t frame) {
  return static_cast<size_t>(std::ranges::upper_bound(starts, frame) - starts.begin()) - 1;
}

void count_recognitions(CountsByView& counts, const Result& result, const GroundTruth& truth,
                        const Monitor& monitor) {
  std::map<std::pair<uint32_t, size_t>, Tally> pairs;  // of one query view
  const auto finish_view = [&] {
    for (const auto& [pair, tally] : pairs) count(counts.recognitions, tally);
    pairs.clear();
  };
  const size_t length = result.window_length();
  size_t present = 0;
  for (const Match& recognition : result.recognitions) {  // in the order of query windows
    check_stop(monitor);
    const size_t anchor = anchor_of(recognition.query, length);
    const size_t view = view_of(result.views->query, anchor);
    if (view != present) finish_view();
    present = view;
    const size_t reference = anchor_of(recognition.train, length);
    add(pairs[{recognition.target, view_of(result.views->train[recognition.target], reference)}],
        truth.label(anchor, recognition.target, reference));
  }
  finish_view();
}

void count_best_matches(CountsByView& counts, const Result& result, const GroundTruth& truth) {
  Tally tally;
  bool any = false;          // window of the present view that has a match
  double correct_share = 0;  // of windows, summed over query views
  const auto finish_view = [&] {
    if (any) count(counts.best_match, tally);
    if (tally.correct > 0)
      correct_share +=
          static_cast<double>(tally.correct) / static_cast<double>(tally.correct + tally.incorrect);
    tally = {};
    any = false;
  };
  size_t present = 0;
  for (const QueryOutcome& query : outcomes_of(result, truth).queries) {
    const size_t view = view_of(result.views->query, query.frame);
    if (view != present) finish_view();
    present = view;
    if (!query.has_match || query.verdict == Verdict::unreadable) continue;
    any = true;
    if (query.verdict == Verdict::correct) ++tally.correct;
    if (query.verdict == Verdict::incorrect) ++tally.incorrect;
  }
  finish_view();
  const ViewCounts& views = counts.best_match;
  const uint64_t judged = views.correct + views.incorrect + views.mixed;
  if (judged > 0) counts.best_match_rate = correct_share / static_cast<double>(judged);
}

}  // namespace

PlaceLabel label_of(const GroundTruth& truth, const Match& match, size_t window_length) {
  return truth.label(anchor_of(match.query, window_length), match.target,
                     anchor_of(match.train, window_length));
}

PlaceLabel label_of(const GroundTruth& truth, const Cluster& cluster, size_t window_length) {
  return truth.label(anchor_of(cluster.query_window, window_length), cluster.target,
                     anchor_of(cluster.train_window, window_length));
}

bool shows_unreadable(const Result& result, size_t window) {
  const auto& frames = result.query.unreadable;
  const auto found = std::lower_bound(frames.begin(), frames.end(), window);
  return found != frames.end() && *found <= anchor_of(window, result.window_length());
}

std::optional<double> BestMatchCounts::rate() const {
  if (queries == ignored) return std::nullopt;
  return static_cast<double>(correct) / static_cast<double>(queries - ignored);
}

GroundTruthScope scope_of(const Result& result) {
  GroundTruthScope scope;
  scope.query = result.query;
  for (const Target& target : result.targets)
    scope.sequences.push_back({target.sequence, target.searched});
  return scope;
}

Clusters clusters_of(const Result& result) {
  if (result.clusters) return *result.clusters;
  Clusters single;
  for (const Match& recognition : result.recognitions) {
    single.of_recognition.push_back(static_cast<uint32_t>(single.all.size()));
    single.all.push_back({recognition.target, recognition.query, recognition.query,
                          recognition.query, recognition.train, recognition.train,
                          recognition.train, 1, recognition.score});
  }
  return single;
}

std::vector<JudgedCluster> judge_clusters(const Result& result, const Clusters& clusters,
                                          const GroundTruth& truth, const Monitor& monitor) {
  assert(clusters.of_recognition.size() == result.recognitions.size());
  const size_t length = result.window_length();
  std::vector<JudgedCluster> judged;
  for (const Cluster& cluster : clusters.all)
    judged.push_back({label_of(truth, cluster, length), {}});
  for (size_t h = 0; h < result.recognitions.size(); ++h) {
    check_stop(monitor);
    count(judged[clusters.of_recognition[h]].recognitions,
          label_of(truth, result.recognitions[h], length));
  }
  return judged;
}

Counts count_recognitions(const Result& result, const GroundTruth& truth, const Monitor& monitor) {
  Counts counts;
  if (result.clusters)
    count_clusters(counts, judge_clusters(result, *result.clusters, truth, monitor));
  else
    count_recognitions(counts, result, truth);
  counts.best_match = best_match_counts(outcomes_of(result, truth));
  return counts;
}

std::optional<CountsByView> count_by_view(const Result& result, const GroundTruth& truth,
                                          const Monitor& monitor) {
  if (!result.views) return std::nullopt;
  CountsByView counts;
  counts.query_views = result.views->query.size();
  for (size_t s = 0; s < result.targets.size(); ++s)
    if (result.targets[s].searched) counts.train_views += result.views->train[s].size();
  count_recognitions(counts, result, truth, monitor);
  count_best_matches(counts, result, truth);
  return counts;
}

}  // namespace vpr
