#include "evaluation/average_precision.h"

namespace vpr {

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

}  // namespace vpr
