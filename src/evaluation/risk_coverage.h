// Risk and coverage: how many mistakes does one accept who wants answers for so many queries?
#pragma once

#include <utility>
#include <vector>

#include "evaluation/metric_value.h"

namespace vpr {

/// The area under the risk-coverage curve (Geifman and El-Yaniv 2017): best matches that have a
/// score are accepted one by one, the most confident first; risk is the share of incorrect ones
/// among those accepted, and the area its mean over all of these steps. 0 is the best, and only
/// without a mistake. Items that score the same enter in an order that is not known: the risk is
/// the expected one over all orders. None where nothing has a score, or there is nothing to find.
MetricValue risk_coverage_area(const Curve& curve);

/// Points (coverage, risk) at the thresholds of the curve; coverage is the share of those that have
/// a score.
std::vector<std::pair<double, double>> risk_coverage_points(const Curve& curve);

}  // namespace vpr
