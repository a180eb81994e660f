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

void add(LabelCounts& counts, const LabelCounts& more) {
  counts.correct += more.correct;
  counts.incorrect += more.incorrect;
  counts.ignored += more.ignored;
}

void count_clusters(Counts& counts, const std::vector<JudgedCluster>& judged) {
  LabelCounts& clusters = counts.clusters.emplace();
  for (const JudgedCluster& cluster : judged) {
    add(counts.hits, cluster.hits);
    count(clusters, cluster.label);
    if (cluster.is_mixed()) ++counts.mixed_clusters;
  }
  counts.distinct = clusters.correct;
}

void count_hits(Counts& counts, const Result& result, const GroundTruth& truth) {
  std::set<std::pair<uint32_t, uint32_t>> recognised;
  for (const Match& hit : result.hits) {
    const PlaceLabel label = label_of(truth, hit, result.window_length());
    count(counts.hits, label);
    if (label == PlaceLabel::same) recognised.insert({hit.target, hit.train});
  }
  counts.distinct = recognised.size();
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
  const auto& frames = result.query_unreadable;
  const auto found = std::lower_bound(frames.begin(), frames.end(), window);
  return found != frames.end() && *found <= anchor_of(window, result.window_length());
}

std::optional<double> BestMatchCounts::rate() const {
  if (queries == ignored) return std::nullopt;
  return static_cast<double>(correct) / static_cast<double>(queries - ignored);
}

GroundTruthScope scope_of(const Result& result) {
  GroundTruthScope scope;
  scope.query_frames = result.query_frames;
  for (const Target& target : result.targets)
    scope.sequences.push_back({target.name, target.frames, target.searched, target.kept});
  scope.replay = result.replay;
  return scope;
}

Clusters clusters_of(const Result& result) {
  if (result.clusters) return *result.clusters;
  Clusters single;
  for (const Match& hit : result.hits) {
    single.of_hit.push_back(static_cast<uint32_t>(single.all.size()));
    single.all.push_back({hit.target, hit.query, hit.query, hit.query, hit.train, hit.train,
                          hit.train, 1, hit.score});
  }
  return single;
}

std::vector<JudgedCluster> judge_clusters(const Result& result, const Clusters& clusters,
                                          const GroundTruth& truth, const Monitor& monitor) {
  assert(clusters.of_hit.size() == result.hits.size());
  const size_t length = result.window_length();
  std::vector<JudgedCluster> judged;
  for (const Cluster& cluster : clusters.all)
    judged.push_back({label_of(truth, cluster, length), {}});
  for (size_t h = 0; h < result.hits.size(); ++h) {
    check_stop(monitor);
    count(judged[clusters.of_hit[h]].hits, label_of(truth, result.hits[h], length));
  }
  return judged;
}

Counts count_recognitions(const Result& result, const GroundTruth& truth, const Monitor& monitor) {
  Counts counts;
  if (result.clusters)
    count_clusters(counts, judge_clusters(result, *result.clusters, truth, monitor));
  else
    count_hits(counts, result, truth);
  counts.best_match = best_match_counts(outcomes_of(result, truth));
  return counts;
}

}  // namespace vpr
