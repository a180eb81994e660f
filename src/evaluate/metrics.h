// Precision-recall curves, the metrics of a curve, and the table of all metrics.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "decide/score_kind.h"

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

/// A number that a precision-recall curve has, of best matches or of all pairs.
struct CurveMetric {
  std::string_view key;     ///< in JSON
  std::string_view column;  ///< in tables
  std::string_view meaning;
  MetricValue (*compute)(const Curve& curve);
  bool is_low_good = false;  ///< small values are better
};

/// All metrics, in the order in which reports and help list them.
std::span<const CurveMetric> curve_metrics();

/// K of recall@K.
inline constexpr std::array<size_t, 4> kRecallAt = {1, 5, 10, 20};

}  // namespace vpr
