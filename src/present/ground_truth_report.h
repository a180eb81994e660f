// What vpr-eval check finds, as JSON (vpr.ground-truth-check/1) and for people.
#pragma once

#include <string>

#include "base/json_fwd.h"
#include "present/run_info.h"
#include "present/table.h"
#include "truth/check.h"

namespace vpr {

/// A ground truth's counts and findings as vpr.ground-truth-check holds them.
Json ground_truth_report_json(const InspectedGroundTruth& ground_truth,
                              const GroundTruthSummary& summary, const RunInfo& run);

/// A row for everything that is counted, and what it means.
Table ground_truth_table(const InspectedGroundTruth& ground_truth,
                         const GroundTruthSummary& summary);

/// The first pairs of everything that is odd, one a line.
std::string ground_truth_examples(const InspectedGroundTruth& ground_truth,
                                  const GroundTruthSummary& summary);

/// What was turned into another format, `target` (vpr.conversion/1).
Json conversion_json(const InspectedGroundTruth& ground_truth, const GroundTruthSummary& summary,
                     std::string_view target);

}  // namespace vpr
