// Comparisons of reports (vpr.comparison/1).
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "evaluation/comparison.h"
#include "report/run_info.h"
#include "report/stored_report.h"

namespace vpr {

/// Everything of the file but "machine" and "timing".
Json comparison_json(const Comparison& comparison, const std::vector<StoredReport>& reports,
                     const std::vector<std::string>& names, size_t resamples, const RunInfo& run);

}  // namespace vpr
