// The table of metrics: reports, help and comparisons read it.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "evaluation/metric_value.h"

namespace vpr {

/// A number that a precision-recall curve has, of best matches or of all pairs.
struct CurveMetric {
  std::string_view key;     ///< in JSON
  std::string_view column;  ///< in tables
  std::string_view meaning;
  MetricValue (*compute)(const Curve& curve);
  bool is_low_good = false;  ///< small values are better
};

/// All metrics, in the order in which reports and help list them.
std::span<const CurveMetric> curve_metrics();

/// K of recall@K.
inline constexpr std::array<size_t, 4> kRecallAt = {1, 5, 10, 20};

}  // namespace vpr
