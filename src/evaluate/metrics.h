// All metrics: of precision-recall curves, of ranked references, of stretches and along the path.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "evaluate/outcomes.h"

namespace vpr {

/// The value of one metric, and where on the curve it is reached.
struct MetricValue {
  std::optional<double> value;      ///< none where it is not defined: nothing to find, say
  std::optional<double> threshold;  ///< the score at which it is reached, where it is one
};

/// AP = sum over thresholds k of (R_k - R_(k-1)) P_k, R_0 = 0, each threshold taking all scores
/// that tie with it; no interpolation (Manning, Raghavan and Schuetze 2008, chapter 8). What is
/// never found adds nothing. None where there is nothing to find.
MetricValue average_precision(const Curve& curve);

/// The largest recall of a threshold at which nothing incorrect is accepted; 0, without a
/// threshold, where something incorrect has the best score (or ties with it). None where there is
/// nothing to find.
MetricValue recall_at_full_precision(const Curve& curve);

/// EP = (P_R0 + R_P100) / 2: the precision at the smallest recall, that of the best score alone,
/// and the recall at 100 % precision (Ferrarini et al., "Exploring Performance Bounds of Visual
/// Place Recognition Using Extended Precision", 2020). A best score that is incorrect has P_R0 = 0.
/// The metric has no value where there is nothing to find, and is 0 where nothing has a score.
MetricValue extended_precision(const Curve& curve);

/// The largest F1 = 2 P R / (P + R) = 2 correct / (accepted + to find) of a threshold (van
/// Rijsbergen 1979); of equals the strictest. 0 without a threshold where nothing correct has a
/// score; none where there is nothing to find.
MetricValue max_f1(const Curve& curve);

/// The probability that something correct scores better than something incorrect, ties counting
/// half (Hanley and McNeil 1982; the Mann-Whitney statistic). What has no score is left out. None
/// where nothing correct or nothing incorrect has a score.
MetricValue roc_auc(const Curve& curve);

/// The area under the risk-coverage curve (Geifman and El-Yaniv 2017): best matches that have a
/// score are accepted one by one, the most confident first; risk is the share of incorrect ones
/// among those accepted, and the area its mean over all of these steps. 0 is the best, and only
/// without a mistake. Items that score the same enter in an order that is not known: the risk is
/// the expected one over all orders. None where nothing has a score, or there is nothing to find.
MetricValue risk_coverage_area(const Curve& curve);

/// Points (coverage, risk) at the thresholds of the curve; coverage is the share of those that have
/// a score.
std::vector<std::pair<double, double>> risk_coverage_points(const Curve& curve);

/// K of recall@K.
inline constexpr std::array<size_t, 4> kRecallAt = {1, 5, 10, 20};

/// The share of judged queries that have a correct reference among their K best, ties to the first,
/// references labeled ignore passed over (queries without a match are left out). K = 1 needs best
/// matches only. None where there is no query to judge, or K > 1 and ranks are not known.
std::optional<double> recall_at(const Outcomes& outcomes, size_t k);

/// The mean over judged queries of the share of right references among their K best, ties to the
/// first, references labeled ignore passed over (Manning, Raghavan, Schuetze 2008, chapter 8).
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

/// A frame of the path: a correct recognition, an incorrect one, one that is not judged (a pair
/// labeled ignore, which counts as none), or none.
enum class Fix { none, right, wrong, unjudged };

/// Meters are none where positions are not known.
struct Localization {
  size_t frames = 0;  ///< of the whole path, frames before the first whole window included
  size_t frames_with_match = 0;  ///< of which the ground truth has a match; set by judge
  size_t right = 0;
  size_t wrong = 0;
  size_t longest_gap_frames = 0;           ///< frames in a row without a right fix
  std::optional<double> longest_gap_m;     ///< walked from a right fix to the next (the path's ends
                                           ///< stand for fixes that are not there)
  std::optional<size_t> first_fix_frames;  ///< frames before the first right fix; none: no fix
  std::optional<double> first_fix_m;       ///< walked before it

  /// right / frames; none for an empty path.
  std::optional<double> share() const;
};

/// `traveled_m`: way from the start to each frame, or empty. As long as `fixes` otherwise.
Localization localize(std::span<const Fix> fixes, std::span<const double> traveled_m);

/// A row of the table of metrics; one of the functions computes it.
struct Metric {
  std::string_view key;      ///< in JSON; of ranks, with _K behind it in comparisons
  std::string_view symbol;   ///< in tables; of ranks and stretches, before K or the target
  std::string_view meaning;  ///< in --help
  bool is_low_good = false;
  int digits = 4;  ///< in tables; 0: an integer
  MetricValue (*of_curve)(const Curve& curve) = nullptr;
  std::optional<double> (*of_ranks)(const Outcomes& outcomes, size_t k) = nullptr;
  std::optional<double> (*of_stretches)(const std::vector<std::optional<double>>& recalls,
                                        double target) = nullptr;
  std::optional<double> (*of_path)(const Localization& path) = nullptr;
};

/// All metrics, in the order in which reports and help list them.
std::span<const Metric> metrics();
/// Those of curves, which stand together, and those of the path.
std::span<const Metric> curve_metrics();
std::span<const Metric> path_metrics();

/// The row of a key, which is in the table.
const Metric& find_metric(std::string_view key);

}  // namespace vpr
