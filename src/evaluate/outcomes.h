// What became of every query: its best match, and whether it is right; and curves over thresholds.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "evaluate/counts.h"
#include "evaluate/score_matrix.h"

namespace vpr {

/// One threshold: what scores exactly this much enters together.
struct CurvePoint {
  uint64_t key = 0;               ///< the threshold as score_key; accepted are keys up to it
  uint64_t correct = 0;           ///< correct ones accepted
  uint64_t incorrect_before = 0;  ///< incorrect ones that score better than the threshold
  uint64_t incorrect = 0;         ///< incorrect ones accepted

  bool operator==(const CurvePoint&) const = default;
};

/// Points from the strictest threshold on: the best score, every score that something correct has,
/// and the worst score. Between two points only incorrect ones enter, so nothing is lost.
struct Curve {
  ScoreOrder kind = ScoreOrder::distance;
  uint64_t to_find = 0;  ///< the denominator of recall: at least the correct ones that have a score
  std::vector<CurvePoint> points;

  double threshold(const CurvePoint& point) const { return score_of_key(point.key, kind); }
  double recall(const CurvePoint& point) const {
    return to_find == 0 ? 0 : static_cast<double>(point.correct) / static_cast<double>(to_find);
  }
  /// Every point has accepted something.
  static double precision(const CurvePoint& point) {
    return static_cast<double>(point.correct) /
           static_cast<double>(point.correct + point.incorrect);
  }
  bool operator==(const Curve&) const = default;
};

/// Something that was scored: a pair, or a query's best match.
struct ScoredItem {
  uint64_t key = 0;
  bool is_correct = false;
  uint32_t weight = 1;  ///< how often it counts; 0: not at all
};

/// Sorts best first; items of one key in any order.
void sort_items(std::vector<ScoredItem>& items);

/// `items` are sorted; those without a score (kNoScore) are left out. No items give no points.
Curve curve_of(std::span<const ScoredItem> items, uint64_t to_find, ScoreOrder kind);

/// What a best match is worth.
enum class Verdict {
  correct,    ///< the best match shows the query's place
  incorrect,  ///< it does not, or nothing was found
  ignored,    ///< it is a pair labeled ignore: neither
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
      {};  ///< that makes it a recognition, where the decision is by margin
};

/// The best matches of all query windows: what curves and metrics are computed from.
struct Outcomes {
  ScoreOrder kind = ScoreOrder::distance;
  size_t query_frames = 0;  ///< of the whole path
  size_t window_length = 1;
  bool has_ranks = false;             ///< from a matrix
  std::vector<QueryOutcome> queries;  ///< by frame
  bool has_margins = false;           ///< from a result that holds them
  /// Accepts best matches; of a result, the one that its recognitions were decided by.
  Confidence confidence = Confidence::score;
};

/// Sets has_match and is_unreachable of the query whose frame is set.
void look_up_match(QueryOutcome& query, const GroundTruth& truth, const ScoreLayout& layout);

/// Gives best matches the margins that a result holds of the same ones, and the confidence that it
/// was decided by.
void add_margins(Outcomes& outcomes, const Result& result);

/// Best matches of a result, judged at anchors; a best match that is labeled ignore is `ignored`
/// (what would have come next is not known). A readable window without one is incorrect.
Outcomes outcomes_of(const Result& result, const GroundTruth& truth);

/// Neither unreadable nor ignored.
bool is_judged(const QueryOutcome& query);

/// Queries that have a match and are judged.
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

}  // namespace vpr
