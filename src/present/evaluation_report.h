// Evaluation reports as JSON: one (vpr.report/1), those of several results (vpr.reports/1), and
// those of one result under several protocols (vpr.protocols/1).
#pragma once

#include <string>
#include <vector>

#include "base/json.h"
#include "present/run_info.h"
#include "run/evaluate.h"
#include "truth/presets.h"

namespace vpr {

/// The query of scores of which nobody says what the query is.
inline constexpr const char* kUnnamedQuery = "queries";

/// Everything of a report but "machine" and "timing", of a result or of scores alone.
Json report_json(const Evaluation& evaluation, const RunInfo& run, const Monitor& monitor = {});

/// Everything of a report but "machine" and "timing". `fingerprint`: the matrix's.
Json scores_report_json(const ScoreSettings& settings, const std::string& query,
                        const Judgement& judgement, const GroundTruth& truth,
                        const std::string& fingerprint, const RunInfo& run);

/// "counts" of a report, or of a cell of a sweep.
Json counts_json(const Counts& counts);
/// Counts of best matches as reports hold them.
Json best_match_json(const BestMatchCounts& counts);

/// Reports are without "machine" and "timing", and have a name each.
Json reports_json(const std::vector<Json>& reports, const std::vector<std::string>& names,
                  const RunInfo& run, double seconds);

/// One result as one of the presets judges it.
struct ProtocolReport {
  const GroundTruthPreset* preset = nullptr;
  Json report;  ///< without "machine" and "timing"
};

Json protocols_json(const std::vector<ProtocolReport>& reports, const RunInfo& run, double seconds);

}  // namespace vpr
