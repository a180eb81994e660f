// What a metric gives.
#pragma once

#include <optional>

#include "evaluation/curve.h"

namespace vpr {

/// The value of one metric, and where on the curve it is reached.
struct MetricValue {
  std::optional<double> value;      ///< none where it is not defined: nothing to find, say
  std::optional<double> threshold;  ///< the score at which it is reached, where it is one
};

}  // namespace vpr
