// Recall at 100 % precision.
#pragma once

#include "evaluation/metric_value.h"

namespace vpr {

/// The largest recall of a threshold at which nothing incorrect is accepted; 0, without a
/// threshold, where something incorrect has the best score (or ties with it). None where there is
/// nothing to find.
MetricValue recall_at_full_precision(const Curve& curve);

}  // namespace vpr
