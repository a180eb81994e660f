#include "evaluate/metrics.h"

#include <algorithm>

namespace vpr {

namespace {

/// Adds the risks of `correct` and `incorrect` ones that enter together behind those accepted.
struct RiskSum {
  double sum = 0;
  uint64_t accepted = 0;
  uint64_t mistakes = 0;

  void add(uint64_t correct, uint64_t incorrect) {
    const uint64_t entering = correct + incorrect;
    if (entering == 0) return;
    const double share = static_cast<double>(incorrect) / static_cast<double>(entering);
    for (uint64_t step = 1; step <= entering; ++step)
      sum += (static_cast<double>(mistakes) + share * static_cast<double>(step)) /
             static_cast<double>(accepted + step);
    accepted += entering;
    mistakes += incorrect;
  }
};

}  // namespace

void sort_items(std::vector<ScoredItem>& items) {
  std::sort(items.begin(), items.end(),
            [](const ScoredItem& a, const ScoredItem& b) { return a.key < b.key; });
}

Curve curve_of(std::span<const ScoredItem> items, uint64_t to_find, ScoreOrder kind) {
  Curve curve{kind, to_find, {}};
  CurvePoint last;  // what has been accepted so far
  bool is_kept = true;
  for (size_t i = 0; i < items.size() && items[i].key != kNoScore;) {
    CurvePoint point{items[i].key, last.correct, last.incorrect, last.incorrect};
    for (; i < items.size() && items[i].key == point.key; ++i)
      (items[i].is_correct ? point.correct : point.incorrect) += items[i].weight;
    if (point.correct == last.correct && point.incorrect == last.incorrect) continue;
    is_kept = curve.points.empty() || point.correct > last.correct;
    if (is_kept) curve.points.push_back(point);
    last = point;
  }
  if (!is_kept) curve.points.push_back(last);
  return curve;
}

MetricValue average_precision(const Curve& curve) {
  if (curve.to_find == 0) return {};
  double sum = 0;
  uint64_t before = 0;
  for (const CurvePoint& point : curve.points) {
    sum += static_cast<double>(point.correct - before) * Curve::precision(point);
    before = point.correct;
  }
  return {sum / static_cast<double>(curve.to_find), {}};
}

MetricValue recall_at_full_precision(const Curve& curve) {
  if (curve.to_find == 0) return {};
  MetricValue best{0, {}};
  for (const CurvePoint& point : curve.points) {
    if (point.incorrect > 0) break;
    best = {curve.recall(point), curve.threshold(point)};
  }
  return best;
}

MetricValue extended_precision(const Curve& curve) {
  if (curve.to_find == 0) return {};
  if (curve.points.empty()) return {0, {}};
  const double at_least_recall = Curve::precision(curve.points.front());
  return {(at_least_recall + *recall_at_full_precision(curve).value) / 2, {}};
}

MetricValue max_f1(const Curve& curve) {
  if (curve.to_find == 0) return {};
  MetricValue best{0, {}};
  for (const CurvePoint& point : curve.points) {
    const uint64_t accepted = point.correct + point.incorrect;
    const double f1 =
        2 * static_cast<double>(point.correct) / static_cast<double>(accepted + curve.to_find);
    if (f1 > *best.value) best = {f1, curve.threshold(point)};
  }
  return best;
}

MetricValue roc_auc(const Curve& curve) {
  if (curve.points.empty()) return {};
  const auto incorrect = static_cast<double>(curve.points.back().incorrect);
  const auto correct = static_cast<double>(curve.points.back().correct);
  if (incorrect == 0 || correct == 0) return {};
  double better = 0;  // pairs (correct, incorrect) that are in order
  uint64_t before = 0;
  for (const CurvePoint& point : curve.points) {
    const auto entering = static_cast<double>(point.correct - before);
    const auto tied = static_cast<double>(point.incorrect - point.incorrect_before);
    const double behind = incorrect - static_cast<double>(point.incorrect);
    better += entering * (behind + tied / 2);
    before = point.correct;
  }
  return {better / (correct * incorrect), {}};
}

MetricValue risk_coverage_area(const Curve& curve) {
  if (curve.to_find == 0) return {};
  RiskSum risks;
  uint64_t correct = 0;
  for (const CurvePoint& point : curve.points) {
    risks.add(0, point.incorrect_before - risks.mistakes);  // mistakes alone, in any order
    risks.add(point.correct - correct, point.incorrect - point.incorrect_before);
    correct = point.correct;
  }
  if (risks.accepted == 0) return {};
  return {risks.sum / static_cast<double>(risks.accepted), {}};
}

std::vector<std::pair<double, double>> risk_coverage_points(const Curve& curve) {
  std::vector<std::pair<double, double>> points;
  if (curve.points.empty()) return points;
  const auto all = static_cast<double>(curve.points.back().correct + curve.points.back().incorrect);
  for (const CurvePoint& point : curve.points)
    points.emplace_back(static_cast<double>(point.correct + point.incorrect) / all,
                        1 - Curve::precision(point));
  return points;
}

std::span<const CurveMetric> curve_metrics() {
  static constexpr std::array<CurveMetric, 6> kMetrics = {
      {{"average_precision", "AP", "precision at every threshold, weighted by the recall it adds",
        average_precision},
       {"recall_at_100_precision", "R@100P", "recall before the first mistake",
        recall_at_full_precision},
       {"max_f1", "max F1", "largest harmonic mean of precision and recall", max_f1},
       {"extended_precision", "EP", "mean of the best score's precision and R@100P",
        extended_precision},
       {"roc_auc", "ROC AUC", "probability that a correct one scores better than an incorrect one",
        roc_auc},
       {"risk_coverage_area", "AURC",
        "mean share of mistakes over all numbers of accepted ones, small is good",
        risk_coverage_area, true}}};
  return kMetrics;
}

}  // namespace vpr
