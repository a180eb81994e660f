// Comparisons of reports (vpr.comparison/1).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "evaluation/comparison.h"
#include "report/run_info.h"
#include "report/table.h"

namespace vpr {

/// What a comparison needs of a report.
struct StoredReport {
  std::string method;
  std::string query;
  std::string ground_truth;  ///< in words
  std::string fingerprint;   ///< of the result or the scores
  Outcomes outcomes;         ///< without the references of best matches
};

/// Throws Error(input) if the file can't be read, Error(data) if it is no report, or damaged.
StoredReport read_report(const std::filesystem::path& path);

/// Everything of the file but "machine" and "timing".
Json comparison_json(const Comparison& comparison, const std::vector<StoredReport>& reports,
                     const std::vector<std::string>& names, size_t resamples, const RunInfo& run);

/// A row for each metric and method.
Table comparison_table(const Json& comparison);
/// Whose best matches are right where.
Table paired_table(const Json& comparison);

}  // namespace vpr
