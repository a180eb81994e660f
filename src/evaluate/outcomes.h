// Best matches, recognitions and clusters judged by the ground truth, and the paper's counts.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "evaluate/score_matrix.h"

namespace vpr {

/// How the ground truth judges the best match, or the recognition, of a query frame.
enum class Verdict {
  correct,    ///< it shows the frame's place
  incorrect,  ///< it shows another place
  ignored,    ///< its pair is labeled ignore
  none        ///< there is none: no readable window ends at the frame, or nothing was found
};
template <>
inline constexpr std::array<std::string_view, 4> kEnumNames<Verdict> = {"correct", "incorrect",
                                                                        "ignored", "none"};

Verdict verdict_of(PlaceLabel label);

/// The value by which best matches are accepted: their score or their margin.
enum class Confidence { score, margin };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<Confidence> = {"score", "margin"};

/// Number of best references of a query whose correctness is stored.
inline constexpr size_t kMaxRank = 100;

/// A query frame and its best match: of the window that ends there.
struct QueryOutcome {
  size_t frame = 0;
  Verdict verdict = Verdict::none;
  bool has_match = false;          ///< in the ground truth
  std::optional<FrameMatch> best;  ///< ties to the first
  uint64_t key = kNoScore;         ///< score_key of the best match
  bool is_tied = false;            ///< another reference has the same score; from a matrix only
  /// 1 + number of references before the first correct one, ties to the first, without skipped ones
  /// (scan_matrix). From a matrix only; unset if no correct reference has a score.
  std::optional<size_t> rank;
  /// Ranks of correct references, ascending, at most kMaxRank. From a matrix only.
  std::vector<uint8_t> correct_ranks = {};
  size_t correct_count = 0;           ///< training frames of the query's place; from a matrix only
  std::optional<double> margin = {};  ///< of the best match, in score per frame; unset: unknown
  std::optional<double> required_margin = {};  ///< minimum of a recognition, if decided by margin
};

/// The best matches of all query frames, from which curves and metrics are computed.
struct Outcomes {
  ScoreOrder kind = ScoreOrder::distance;
  size_t window_length = 1;
  std::vector<QueryOutcome> queries;  ///< one per query frame
  bool has_scores = true;             ///< false: best matches are known, but not how good they are
  bool has_ranks = false;             ///< from a matrix
  /// The largest K for which the K best references of every frame with a match are known.
  size_t known_ranks = std::numeric_limits<size_t>::max();
  size_t unscored = 0;       ///< queries without any score; from a matrix only
  bool has_margins = false;  ///< from a result with margins
  /// Initially the value by which the recognitions of the result were decided.
  Confidence confidence = Confidence::score;

  /// The entry of a query window.
  QueryOutcome& at_window(size_t window) { return queries[window + window_length - 1]; }
};

/// The frames of a query, without best matches.
Outcomes unanswered(const GroundTruth& truth, size_t query_frames, size_t window_length,
                    ScoreOrder kind);

/// Copies the margins of a result to equal best matches, and sets the confidence of its decision.
void add_margins(Outcomes& outcomes, const Result& result);

/// The best matches of a result, judged at anchors.
Outcomes outcomes_of(const Result& result, const GroundTruth& truth);

/// Number of query frames with a match: the denominator of recall.
uint64_t frames_with_match(const Outcomes& outcomes);

/// Whether the best match counts in a curve: it is correct or incorrect.
bool is_judged(const QueryOutcome& query);

/// Smaller keys are more confident; kNoScore, which is never accepted, if the value is unknown.
uint64_t confidence_key(const QueryOutcome& query, Confidence by);
ScoreOrder confidence_order(const Outcomes& outcomes);

/// Query frames by the verdict on their best match.
struct BestMatchCounts {
  uint64_t frames = 0;   ///< with a match in the ground truth
  uint64_t correct = 0;  ///< these four add up to `frames`
  uint64_t incorrect = 0;
  uint64_t ignored = 0;
  uint64_t no_answer = 0;
  uint64_t without_match = 0;  ///< other frames; their best matches are incorrect

  /// correct / frames; unset without frames.
  std::optional<double> rate() const;
  bool operator==(const BestMatchCounts&) const = default;
};

BestMatchCounts best_match_counts(const Outcomes& outcomes);

struct LabelCounts {
  uint64_t correct = 0;
  uint64_t incorrect = 0;
  uint64_t ignored = 0;

  void add(PlaceLabel label, uint64_t pairs = 1);
  uint64_t all() const { return correct + incorrect + ignored; }
  bool operator==(const LabelCounts&) const = default;
};

/// Counts of the recognitions, clusters and best matches of a result.
struct Counts {
  LabelCounts recognitions;  ///< judged at both anchors (FAB-MAP: frame and place)
  /// Each with the verdict on the representative of its cluster (paper, section 3.2).
  std::optional<LabelCounts> recognitions_by_place;
  std::optional<LabelCounts> clusters;     ///< judged at the anchors of their representatives
  std::optional<uint64_t> mixed_clusters;  ///< correct clusters with incorrect recognitions
  uint64_t distinct = 0;  ///< correct clusters; without clusters, correctly recognized places
  BestMatchCounts best_match;
};

/// A cluster by ground truth. A correct representative does not make its recognitions correct.
struct JudgedCluster {
  PlaceLabel label = PlaceLabel::different;  ///< at the anchors of the representative
  LabelCounts recognitions;

  bool is_mixed() const { return label == PlaceLabel::same && recognitions.incorrect > 0; }
};

/// Sets the counts of clusters, mixed clusters, recognitions by place, and distinct.
void count_clusters(Counts& counts, const std::vector<JudgedCluster>& clusters);

PlaceLabel label_of(const GroundTruth& truth, const MatchedFrame& matched);
/// The label of a match at the anchors of its windows.
PlaceLabel label_of(const GroundTruth& truth, const Match& match, size_t window_length);
/// The label of the representative of a cluster.
PlaceLabel label_of(const GroundTruth& truth, const Cluster& cluster, size_t window_length);

/// The clusters of a result; without clusters, each recognition as its own cluster.
Clusters clusters_of(const Result& result);

/// One entry per cluster of clusters_of(result).
std::vector<JudgedCluster> judge_clusters(const Result& result, const GroundTruth& truth,
                                          const Monitor& monitor = {});

/// Windows are judged at their anchors. Best matches are not counted (best_match_counts).
Counts count_recognitions(const Result& result, const GroundTruth& truth,
                          const Monitor& monitor = {});

/// Keyframes, or pairs of keyframes, by the labels of their frames.
struct KeyframeCounts {
  uint64_t correct = 0;    ///< all are correct
  uint64_t incorrect = 0;  ///< all are incorrect
  uint64_t mixed = 0;      ///< both occur
  uint64_t ignored = 0;    ///< all are ignored; ignored frames do not count otherwise

  bool operator==(const KeyframeCounts&) const = default;
};

/// Counts in which each keyframe counts once, however many frames it stands for.
struct CountsByKeyframe {
  size_t query_keyframes = 0;
  size_t train_keyframes = 0;   ///< of the searched sequences
  KeyframeCounts recognitions;  ///< pairs of keyframes with recognitions
  KeyframeCounts best_match;    ///< query keyframes with a match in the ground truth
  /// Mean over query keyframes of their share of correct best matches; unset without a judged one.
  std::optional<double> best_match_rate;
  /// Recall at 100 % precision of query keyframes, each with the most confident best match of its
  /// frames, except ignored ones, which is correct if any frame of its training keyframe is a
  /// match; unset if it is not defined.
  std::optional<double> recall_at_full_precision;
};

/// Windows belong to the keyframes of their anchors. `outcomes`: of the result. Unset for a result
/// without keyframes.
std::optional<CountsByKeyframe> count_by_keyframe(const Result& result, const GroundTruth& truth,
                                                  const Outcomes& outcomes,
                                                  const Monitor& monitor = {});

}  // namespace vpr
