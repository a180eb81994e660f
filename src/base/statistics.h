// Order statistics of measured values.
#pragma once

#include <vector>

namespace vpr {

/// The p-quantile, p in [0, 1], linear between order statistics (Hyndman & Fan's type 7, NumPy's
/// default). values must not be empty.
double quantile(std::vector<double> values, double p);

/// The middle value, or the mean of the two middle values. values must not be empty.
double median(std::vector<double> values);

}  // namespace vpr
