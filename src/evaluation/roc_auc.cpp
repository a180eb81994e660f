#include "evaluation/roc_auc.h"

namespace vpr {

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

}  // namespace vpr
