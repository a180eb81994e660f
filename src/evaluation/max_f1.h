// Maximum F1 score.
#pragma once

#include "evaluation/metric_value.h"

namespace vpr {

/// The largest F1 = 2 P R / (P + R) = 2 correct / (accepted + to find) of a threshold (van
/// Rijsbergen 1979); of equals the strictest. 0 without a threshold where nothing correct has a
/// score; none where there is nothing to find.
MetricValue max_f1(const Curve& curve);

}  // namespace vpr
