#include "evaluation/extended_precision.h"

#include "evaluation/full_precision_recall.h"

namespace vpr {

MetricValue extended_precision(const Curve& curve) {
  if (curve.to_find == 0) return {};
  if (curve.points.empty()) return {0, {}};
  const double at_least_recall = Curve::precision(curve.points.front());
  return {(at_least_recall + *recall_at_full_precision(curve).value) / 2, {}};
}

}  // namespace vpr
