// Precision-recall curves and all metrics: of curves, ranks, stretches and the path.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "evaluate/outcomes.h"

namespace vpr {

/// One threshold; equal scores are accepted together.
struct CurvePoint {
  uint64_t key = 0;               ///< the threshold as score_key; keys up to it are accepted
  uint64_t correct = 0;           ///< accepted
  uint64_t incorrect_before = 0;  ///< incorrect, with a better score than the threshold
  uint64_t incorrect = 0;         ///< accepted

  bool operator==(const CurvePoint&) const = default;
};

/// Points from the strictest threshold on: the best score, every score of a correct item and the
/// worst score. Only incorrect items lie between two points, so no information is lost.
struct Curve {
  ScoreOrder kind = ScoreOrder::distance;
  uint64_t positives = 0;  ///< the denominator of recall; correct items without a score count
  std::vector<CurvePoint> points;
  bool has_scores = true;  ///< false: the order of items is unknown, and so is every metric

  double threshold(const CurvePoint& point) const { return score_of_key(point.key, kind); }
  double recall(const CurvePoint& point) const {
    return positives == 0 ? 0 : static_cast<double>(point.correct) / static_cast<double>(positives);
  }
  bool is_measurable() const { return has_scores && positives > 0; }
  /// Every point has accepted an item.
  static double precision(const CurvePoint& point) {
    return static_cast<double>(point.correct) /
           static_cast<double>(point.correct + point.incorrect);
  }
  bool operator==(const Curve&) const = default;
};

/// A pair, or the best match of a query.
struct ScoredItem {
  uint64_t key = 0;
  bool is_correct = false;
  uint32_t weight = 1;  ///< number of times that it counts
};

/// Sorts best first; items of one key in any order.
void sort_items(std::vector<ScoredItem>& items);

/// `items` are sorted; those without a score (kNoScore) are skipped. No items yield no points.
Curve curve_of(std::span<const ScoredItem> items, uint64_t positives, ScoreOrder kind);

/// Best matches by confidence, except ignored ones. Those of frames without a match are incorrect.
/// Recall is over frames_with_match. `weights`: how often each frame counts, by
/// QueryOutcome::frame; empty: once.
Curve single_best_curve(const Outcomes& outcomes, std::span<const uint32_t> weights = {});

struct MetricValue {
  std::optional<double> value;      ///< unset if it is not defined
  std::optional<double> threshold;  ///< the score at which it is reached, if it has one
};

/// AP = sum over thresholds k of (R_k - R_(k-1)) P_k, R_0 = 0; equal scores share a threshold; no
/// interpolation (Manning, Raghavan and Schuetze 2008, chapter 8). Items without a score add
/// nothing. Unset if positives is 0.
MetricValue average_precision(const Curve& curve);

/// The largest recall of a threshold that accepts nothing incorrect; 0, without a threshold, if an
/// incorrect item has or shares the best score. Unset if positives is 0.
MetricValue recall_at_full_precision(const Curve& curve);

/// EP = (P_R0 + R_P100) / 2: the mean of the precision of the best score and the recall at 100 %
/// precision (Ferrarini et al., "Exploring Performance Bounds of Visual Place Recognition Using
/// Extended Precision", 2020). P_R0 is 0 if the best score is incorrect. EP is 0 without scores and
/// unset if positives is 0.
MetricValue extended_precision(const Curve& curve);

/// The largest F1 = 2 P R / (P + R) = 2 correct / (accepted + positives) of a threshold (van
/// Rijsbergen 1979), ties to the strictest. 0, without a threshold, if no correct item has a score;
/// unset if positives is 0.
MetricValue max_f1(const Curve& curve);

/// The probability that a correct item scores better than an incorrect one, ties counting half
/// (Hanley and McNeil 1982; the Mann-Whitney statistic). Items without a score are skipped. Unset
/// unless a correct and an incorrect item have a score.
MetricValue roc_auc(const Curve& curve);

/// The area under the risk-coverage curve (Geifman and El-Yaniv 2017): items with a score are
/// accepted one by one, the most confident first; the risk is the share of incorrect ones among
/// those accepted, and the area is its mean over these steps. 0 is best. For equal scores, the risk
/// is the expected value over all orders. Unset without scores or if positives is 0.
MetricValue risk_coverage_area(const Curve& curve);

/// Points (coverage, risk) at the thresholds; coverage is the share of the items with a score.
std::vector<std::pair<double, double>> risk_coverage_points(const Curve& curve);

/// K of recall@K.
inline constexpr std::array<size_t, 4> kRecallAt = {1, 5, 10, 20};

/// Targets of recall achievement rates, and the default number of frames per stretch.
inline constexpr std::array<double, 4> kRecallTargets = {0.5, 0.75, 0.9, 1.0};
inline constexpr size_t kDefaultStretch = 25;

/// Recall@1 per stretch of the path; unset for a stretch without a frame that has a match.
/// All frames of the query are divided into round(frames / stretch_frames) stretches, at least one,
/// whose lengths differ by at most one frame. stretch_frames is at least 1.
std::vector<std::optional<double>> local_recalls(const Outcomes& outcomes, size_t stretch_frames);

/// The share of stretches, among those with a recall, whose recall is `target` or more (Hussaini,
/// Fischer, Milford 2026). Unset if no stretch has one.
std::optional<double> recall_achievement(const std::vector<std::optional<double>>& recalls,
                                         double target);

/// The source of verdicts, from the most to the least known.
enum class JudgedBy {
  ground_truth,  ///< of pairs
  places,        ///< answers to the places of a result
  nothing
};
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<JudgedBy> = {"ground_truth", "places",
                                                                         "nothing"};

/// Fixes along the path. Meters are unset if positions are unknown.
struct Localization {
  uint64_t frames = 0;             ///< of the whole query, frames before the first anchor included
  uint64_t recognized = 0;         ///< with a recognition of any label
  uint64_t frames_with_match = 0;  ///< in the ground truth; set by judge
  uint64_t correct = 0;
  uint64_t incorrect = 0;
  uint64_t off_map = 0;  ///< of the incorrect ones, without a match; set by judge
  std::optional<uint64_t> longest_gap_frames;  ///< consecutive frames without a correct
                                               ///< recognition; unset: some frames are omitted
  std::optional<double> longest_gap_m;  ///< traveled between two correct recognitions; the ends of
                                        ///< the path count as verdicts here
  std::optional<uint64_t> first_recognition_frames;  ///< frames before the decision on the first
                                                     ///< correct recognition; unset: none
  std::optional<double> first_recognition_m;         ///< traveled before it

  /// correct / frames_with_match; unset without a frame that has a match.
  std::optional<double> share() const;
  /// recognized / frames; unset for an empty path.
  std::optional<double> recognized_share() const;
};

/// Frames by their best accepted matches, and all accepted pairs.
struct FrameCounts {
  Localization path;
  LabelCounts pairs;

  /// Incorrect frames or, if there are more, incorrect pairs.
  uint64_t incorrect() const { return std::max<uint64_t>(path.incorrect, pairs.incorrect); }
};

/// `verdicts`: of the recognition of each frame; none without one, and an ignored one counts as
/// none. `traveled_m`: the distance from the start to each frame, or empty. `decided`: the frame of
/// the path at which each frame was recognized, as in ResultPath; empty: at once.
Localization localize(std::span<const Verdict> verdicts, std::span<const double> traveled_m,
                      std::span<const std::optional<uint32_t>> decided = {});

template <class S>
using ValueOf =
    std::variant<std::optional<double> (S::*)() const, uint64_t S::*, std::optional<uint64_t> S::*,
                 std::optional<double> S::*, LabelCounts S::*, std::optional<LabelCounts> S::*>;

/// Tables of several methods, each with the columns of the ones before.
enum class TableDetail {
  brief,  ///< on a terminal, and LaTeX
  full,   ///< -v, Markdown and pages
  data    ///< CSV
};

/// A row of the table of metrics; exactly one of its last members is set.
struct Metric {
  std::string_view key;           ///< in JSON; metrics of ranks append _K in comparisons
  std::string_view symbol;        ///< in tables; K, the target or the verdict follows
  std::string_view meaning = {};  ///< in --help; empty: a count, or in JSON only
  std::string_view about = {};    ///< in the schema, without a meaning
  std::string_view title = {};    ///< of a table, for metrics of ranks
  bool is_low_good = false;
  bool is_share = false;                    ///< of the frames with a match, for K = 1
  bool is_percent = false;                  ///< in tables
  bool needs_all_ranks = false;             ///< of correct references, not only the first
  int digits = 4;                           ///< in tables; 0: an integer
  JudgedBy needs = JudgedBy::ground_truth;  ///< the least known source of verdicts
  TableDetail detail = TableDetail::data;   ///< the first table that has it; of counts by verdict,
                                            ///< only the incorrect ones are in the first two
  MetricValue (*of_curve)(const Curve& curve) = nullptr;
  /// A metric of ranks is the mean of this over query frames with a match.
  double (*of_query)(const QueryOutcome& query, size_t k) = nullptr;
  std::optional<double> (*of_stretches)(const std::vector<std::optional<double>>& recalls,
                                        double target) = nullptr;
  std::optional<ValueOf<Localization>> of_path = {};
  std::optional<ValueOf<BestMatchCounts>> of_best_match = {};
  std::optional<ValueOf<Counts>> of_counts = {};

  std::string_view description() const { return meaning.empty() ? about : meaning; }
  bool has_verdicts() const;
  /// Whether a metric of ranks can be computed at K.
  bool is_known_at(const Outcomes& outcomes, size_t k) const;
};

/// All metrics, in the order of tables and help.
std::span<const Metric> metrics();
std::span<const Metric> curve_metrics();
std::span<const Metric> rank_metrics();

/// `key` must be in the table.
const Metric& find_metric(std::string_view key);

/// The value of `from`. `verdict`: of a count by verdicts; null: their sum.
template <class S>
std::optional<double> value_in(const S& from, const ValueOf<S>& row,
                               uint64_t LabelCounts::*verdict = nullptr) {
  const auto number = [&](const auto& value) -> std::optional<double> {
    if constexpr (std::is_convertible_v<decltype(value), std::optional<LabelCounts>>) {
      const std::optional<LabelCounts> counts = value;
      if (!counts) return std::nullopt;
      return verdict != nullptr ? (*counts).*verdict : counts->all();
    } else {
      return value;
    }
  };
  return std::visit([&](auto member) { return number(std::invoke(member, from)); }, row);
}

/// A metric, with K for metrics of ranks, and a verdict for counts by verdicts.
struct MetricAt {
  const Metric* metric = nullptr;
  size_t k = 0;
  uint64_t LabelCounts::*verdict = nullptr;

  std::string key() const;     ///< "recall_at_5"
  std::string symbol() const;  ///< "R@5", "pairs correct"
  bool operator==(const MetricAt&) const = default;
};
/// `key`: of a metric or, with a verdict, "pairs.correct".
MetricAt metric_at(std::string_view key, size_t k = 0);

/// A metric of ranks: ties to the first, references labeled ignore skipped (scan_matrix), missing
/// ranks incorrect. Unset if no query frame has a match, or unless is_known_at. `weights`: as in
/// single_best_curve.
std::optional<double> rank_value(const MetricAt& metric, const Outcomes& outcomes,
                                 std::span<const uint32_t> weights = {});
std::optional<double> recall_at(const Outcomes& outcomes, size_t k);

}  // namespace vpr
