// Evaluation reports (vpr.report/1) of score matrices of any program.
#pragma once

#include <string>

#include "base/json_fwd.h"
#include "pipeline/evaluate.h"
#include "report/run_info.h"
#include "report/table.h"

namespace vpr {

/// The query of scores of which nobody says what the query is.
inline constexpr const char* kUnnamedQuery = "queries";

/// Everything of a report but "machine" and "timing". `fingerprint`: the matrix's.
Json scores_report_json(const ScoreSettings& settings, const std::string& query,
                        const Judgement& judgement, const GroundTruth& truth,
                        const std::string& fingerprint, const RunInfo& run);

/// The first table of any report, of one row: of a result, or of a matrix and its best matches.
Table summary_table(const Json& report);

}  // namespace vpr
