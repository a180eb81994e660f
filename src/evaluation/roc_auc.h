// Area under the receiver operating characteristic.
#pragma once

#include "evaluation/metric_value.h"

namespace vpr {

/// The probability that something correct scores better than something incorrect, ties counting
/// half (Hanley and McNeil 1982; the Mann-Whitney statistic). What has no score is left out. None
/// where nothing correct or nothing incorrect has a score.
MetricValue roc_auc(const Curve& curve);

}  // namespace vpr
