// The results of vpr-eval check (vpr.ground-truth-check/3) and convert (vpr.conversion/3).
#pragma once

#include <string>

#include "base/json_fwd.h"
#include "files/run_info.h"
#include "present/table.h"
#include "truth/ground_truth.h"

namespace vpr {

Json ground_truth_report_json(const InspectedGroundTruth& ground_truth,
                              const GroundTruthSummary& summary, const RunInfo& run);

/// A row per count, with its meaning.
Table ground_truth_table(const InspectedGroundTruth& ground_truth,
                         const GroundTruthSummary& summary);

/// The first pairs of each finding, one per line.
std::string ground_truth_examples(const InspectedGroundTruth& ground_truth,
                                  const GroundTruthSummary& summary);

/// `target`: the other format.
Json conversion_json(const InspectedGroundTruth& ground_truth, const GroundTruthSummary& summary,
                     std::string_view target);

}  // namespace vpr
