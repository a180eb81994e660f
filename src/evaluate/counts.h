// The paper's counts: correct, incorrect and distinct recognitions, and the best match.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "decide/result.h"
#include "truth/ground_truth.h"

namespace vpr {

/// Pairs by what the ground truth calls them.
struct LabelCounts {
  uint64_t correct = 0;
  uint64_t incorrect = 0;
  uint64_t ignored = 0;  ///< pairs labeled ignore: neither
};

/// Query windows by whether their best match is right.
struct BestMatchCounts {
  uint64_t queries = 0;  ///< windows (frames) with a match in the ground truth, ignored ones too
  uint64_t correct = 0;
  uint64_t ignored = 0;        ///< of `queries`: the best match is an ignored pair
  uint64_t without_match = 0;  ///< windows whose anchor has no match; not in `queries`
  uint64_t unreachable = 0;    ///< whose anchor has matches only where no training window ends, in
                               ///< the first c_l - 1 frames; not in `queries`
  uint64_t unreadable = 0;     ///< windows with an unreadable frame; not in `queries`

  /// correct / (queries - ignored); none where there are none.
  std::optional<double> rate() const;
};

/// How often a result is right: its recognitions, their clusters, and its best matches.
struct Counts {
  LabelCounts recognitions;             ///< judged at both anchors; of FAB-MAP frame and place
  std::optional<LabelCounts> clusters;  ///< judged at their representative's anchors
  uint64_t mixed_clusters = 0;          ///< correct ones of whose recognitions some are incorrect
  uint64_t distinct = 0;  ///< correct clusters; without any, places recognized correctly at least
                          ///< once
  BestMatchCounts best_match;
};

/// A cluster as the ground truth sees it: its representative may lie at a correct pair although
/// many, or most, of its recognitions do not.
struct JudgedCluster {
  PlaceLabel label = PlaceLabel::different;  ///< at its representative's anchors
  LabelCounts recognitions;

  bool is_mixed() const { return label == PlaceLabel::same && recognitions.incorrect > 0; }
};

/// The clusters of a result, or, of one without clusters, every recognition as one of its own.
Clusters clusters_of(const Result& result);

/// One for each of the clusters, in their order.
std::vector<JudgedCluster> judge_clusters(const Result& result, const Clusters& clusters,
                                          const GroundTruth& truth, const Monitor& monitor = {});

/// What the ground truth says of a match, at the anchors of its windows.
PlaceLabel label_of(const GroundTruth& truth, const Match& match, size_t window_length);
/// The same of a cluster's representative.
PlaceLabel label_of(const GroundTruth& truth, const Cluster& cluster, size_t window_length);

/// Whether a query window has an unreadable frame.
bool shows_unreadable(const Result& result, size_t window);

/// The scope in which a result's indices are to be read. The ground truth of places counts them as
/// that of sequences counts frames.
GroundTruthScope scope_of(const Result& result);

/// Windows are judged at their anchor, their last frame. A frame without words is a query that is
/// wrong.
Counts count_recognitions(const Result& result, const GroundTruth& truth,
                          const Monitor& monitor = {});

/// Views, or pairs of views, by what their frames are.
struct ViewCounts {
  uint64_t correct = 0;    ///< all are correct
  uint64_t incorrect = 0;  ///< all are incorrect
  uint64_t mixed = 0;      ///< some are correct and some are not
  uint64_t ignored = 0;    ///< all are ignored, which otherwise count for nothing
};

/// Counts in which every view counts once, however many frames show it.
struct CountsByView {
  size_t query_views = 0;
  size_t train_views = 0;   ///< of the searched sequences
  ViewCounts recognitions;  ///< pairs of a query view and a training view that have recognitions
  ViewCounts best_match;    ///< query views that have windows with a match
  /// The rate of best matches where every view counts as much as any other; none without one.
  std::optional<double> best_match_rate;
};

/// Windows belong to the views of their anchors, and are judged there. Nothing for a result that
/// does not say where its views begin.
std::optional<CountsByView> count_by_view(const Result& result, const GroundTruth& truth,
                                          const Monitor& monitor = {});

}  // namespace vpr
