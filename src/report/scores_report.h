// Evaluation reports (vpr.report/1) of score matrices of any program.
#pragma once

#include <string>

#include "base/json_fwd.h"
#include "evaluation/judgement.h"
#include "report/run_info.h"
#include "report/table.h"

namespace vpr {

/// The query of scores of which nobody says what the query is.
inline constexpr const char* kUnnamedQuery = "queries";

/// What is known of a score matrix; keys of "settings".
struct ScoreSettings {
  std::string method = "scores";  ///< a name for tables
  ScoreFormat format;
  uint64_t window_length = 1;       ///< rows and columns are windows of so many frames
  std::optional<double> threshold;  ///< of a fix; none: that of recall at 100 % precision
};

/// Everything of a report but "machine" and "timing". `fingerprint`: the matrix's.
Json scores_report_json(const ScoreSettings& settings, const std::string& query,
                        const Judgement& judgement, const GroundTruth& truth,
                        const std::string& fingerprint, const RunInfo& run);

/// One row: the matrix and its best matches.
Table scores_table(const Json& report);

/// The first table of any report: of a result or a matrix.
Table summary_table(const Json& report);

}  // namespace vpr
