#include "evaluation/full_precision_recall.h"

namespace vpr {

MetricValue recall_at_full_precision(const Curve& curve) {
  if (curve.to_find == 0) return {};
  MetricValue best{0, {}};
  for (const CurvePoint& point : curve.points) {
    if (point.incorrect > 0) break;
    best = {curve.recall(point), curve.threshold(point)};
  }
  return best;
}

}  // namespace vpr
