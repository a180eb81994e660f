// Average precision.
#pragma once

#include "evaluation/metric_value.h"

namespace vpr {

/// AP = sum over thresholds k of (R_k - R_(k-1)) P_k, R_0 = 0, each threshold taking all scores
/// that tie with it; no interpolation (Manning, Raghavan and Schuetze 2008, chapter 8). What is
/// never found adds nothing. None where there is nothing to find.
MetricValue average_precision(const Curve& curve);

}  // namespace vpr
