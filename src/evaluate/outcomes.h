// What became of every query: its best match, and whether it is right.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "evaluate/counts.h"
#include "evaluate/metrics.h"
#include "evaluate/score_matrix.h"

namespace vpr {

/// What a best match is worth.
enum class Verdict {
  correct,    ///< the best match shows the query's place
  incorrect,  ///< it does not, or nothing was found
  ignored,    ///< it is a pair labelled ignore: neither
  unreadable  ///< the query has no scores: not judged
};

/// What best matches are accepted by: their score, or their margin, how much better they are than
/// the best one elsewhere.
enum class Confidence { score, margin };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<Confidence> = {"score", "margin"};

/// Of how many best references of a query it is kept whether they are right.
inline constexpr size_t kMostRanked = 100;

/// One query window (of FAB-MAP: frame), and its best match.
struct QueryOutcome {
  size_t frame = 0;  ///< of the query: a window's anchor
  Verdict verdict = Verdict::incorrect;
  bool has_match = false;          ///< the ground truth has this place where a reference is judged
  bool is_unreachable = false;     ///< it has it, but only where no training window ends
  std::optional<FrameMatch> best;  ///< ties to the first
  uint64_t key = kNoScore;         ///< score_key of the best match
  bool is_tied = false;            ///< another reference scores the same (known from a matrix only)
  /// 1 + references in front of the first correct one, ties to the first, ignored ones left out;
  /// known from a matrix only, and none where no correct one has a score.
  std::optional<size_t> rank;
  /// Ranks of right references, rising, as far as they are known: up to kMostRanked, from a matrix.
  std::vector<uint8_t> right_ranks = {};
  size_t right_count = 0;             ///< references of the query's place; from a matrix
  std::optional<double> margin = {};  ///< of the best match, in score a frame; none: not known
  std::optional<double> asked_margin =
      {};  ///< that makes it a hit, where the decision is by margin
};

/// The best matches of all query windows: what curves and metrics are computed from.
struct Outcomes {
  ScoreOrder kind = ScoreOrder::distance;
  size_t query_frames = 0;  ///< of the whole path
  size_t window_length = 1;
  bool has_ranks = false;             ///< from a matrix
  std::vector<QueryOutcome> queries;  ///< by frame
  bool has_margins = false;           ///< from a result that holds them
  /// Accepts best matches; of a result, the one that its hits were decided by.
  Confidence confidence = Confidence::score;
};

/// Sets has_match and is_unreachable of the query whose frame is set.
void look_up_match(QueryOutcome& query, const GroundTruth& truth, const ScoreLayout& layout);

/// Gives best matches the margins that a result holds of the same ones, and the confidence that it
/// was decided by.
void add_margins(Outcomes& outcomes, const Result& result);

/// Best matches of a result, judged at anchors; a best match that is labelled ignore is `ignored`
/// (what would have come next is not known). A readable window without one is incorrect.
Outcomes outcomes_of(const Result& result, const GroundTruth& truth);

/// Queries that have a match and are judged: neither unreadable nor ignored.
uint64_t judged_queries(const Outcomes& outcomes);
/// Queries of which two references score the same and best.
uint64_t tied_queries(const Outcomes& outcomes);

/// The outcomes as a report counts best matches.
BestMatchCounts best_match_counts(const Outcomes& outcomes);

/// Smaller keys are more confident; kNoScore where the best match has none: it is never accepted.
uint64_t confidence_key(const QueryOutcome& query, Confidence by);
/// The order of the outcomes' confidence.
ScoreOrder confidence_order(const Outcomes& outcomes);

/// Whether a query's best match is accepted or not at each threshold of its score, or its margin:
/// correct and incorrect best matches, those of queries without a match among the incorrect ones;
/// unreadable and ignored ones left out. Recall is over judged_queries.
Curve single_best_curve(const Outcomes& outcomes);

/// Whether a judged query has a correct reference among its K best.
bool is_found_at(const QueryOutcome& query, size_t k);

/// The share of judged queries that have a correct reference among their K best, ties to the first,
/// references labelled ignore passed over (queries without a match are left out). K = 1 needs best
/// matches only. None where there is no query to judge, or K > 1 and ranks are not known.
std::optional<double> recall_at(const Outcomes& outcomes, size_t k);

/// The mean over judged queries of the share of right references among their K best, ties to the
/// first, references labelled ignore passed over (Manning, Raghavan, Schuetze 2008, chapter 8).
/// What is missing of K counts as wrong. K is 1 or more. None where there is no query to judge,
/// ranks are not known, or K is above kMostRanked.
std::optional<double> precision_at(const Outcomes& outcomes, size_t k);

/// The mean over judged queries of AP@K: the sum of precision@i over the i up to K whose reference
/// is right, divided by the right ones that K could hold, min(K, right references of the query)
/// (Weyand et al. 2020). Else as precision_at.
std::optional<double> mean_average_precision_at(const Outcomes& outcomes, size_t k);

/// Local recalls that are asked for, and frames of a stretch where nobody says otherwise.
inline constexpr std::array<double, 4> kRecallTargets = {0.5, 0.75, 0.9, 1.0};
inline constexpr size_t kRouteStretch = 25;

/// Recall@1 of one stretch of the path; none where it has no judged query with a match.
std::vector<std::optional<double>> local_recalls(const Outcomes& outcomes, size_t stretch_frames);

/// The share of stretches whose local recall@1 is `target` or more (Hussaini, Fischer, Milford
/// 2026). The path, all frames of the query, is cut into as many stretches as have about
/// `stretch_frames` (1 or more) frames each, at least one, as equally long as whole frames can be;
/// stretches without a judged query that has a match are left out. None where all are.
std::optional<double> recall_achievement(const std::vector<std::optional<double>>& recalls,
                                         double target);

}  // namespace vpr
