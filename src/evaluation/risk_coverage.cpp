#include "evaluation/risk_coverage.h"

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

}  // namespace vpr
