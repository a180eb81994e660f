#include "evaluation/max_f1.h"

namespace vpr {

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

}  // namespace vpr
