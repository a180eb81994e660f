// Extended precision.
#pragma once

#include "evaluation/metric_value.h"

namespace vpr {

/// EP = (P_R0 + R_P100) / 2: the precision at the smallest recall, that of the best score alone,
/// and the recall at 100 % precision (Ferrarini et al., "Exploring Performance Bounds of Visual
/// Place Recognition Using Extended Precision", 2020). A best score that is incorrect has P_R0 = 0.
/// The metric has no value where there is nothing to find, and is 0 where nothing has a score.
MetricValue extended_precision(const Curve& curve);

}  // namespace vpr
