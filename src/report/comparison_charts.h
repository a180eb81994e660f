// Several methods in one chart.
#pragma once

#include <span>
#include <vector>

#include "report/chart.h"
#include "report/stored_report.h"

namespace vpr {

/// Precision against recall of best matches, a curve for each report over its own queries. Reports
/// without a query to find have none.
Chart curves_overlay(const std::string& title, std::span<const StoredReport> reports,
                     const std::vector<std::string>& names);

/// The path from left to right, a lane for each report: where it is right, wrong or not judged. Of
/// reports that hold no fixes (of older versions) the lane has best matches, in pale colours. A
/// replayed query has its own frames: its lane is as long as they are.
Chart lanes_chart(const std::string& title, std::span<const StoredReport> reports,
                  const std::vector<std::string>& names);

}  // namespace vpr
