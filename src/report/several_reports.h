// Several evaluation reports in one file: of several results (vpr.reports/1), and of one result
// under several protocols (vpr.protocols/1).
#pragma once

#include <string>
#include <vector>

#include "base/json.h"
#include "ground_truth/presets.h"
#include "report/run_info.h"
#include "report/table.h"

namespace vpr {

/// Reports are without "machine" and "timing", and have a name each.
Json reports_json(const std::vector<Json>& reports, const std::vector<std::string>& names,
                  const RunInfo& run, double seconds);

/// One result as one of the presets judges it.
struct ProtocolReport {
  const GroundTruthPreset* preset = nullptr;
  Json report;  ///< without "machine" and "timing"
};

Json protocols_json(const std::vector<ProtocolReport>& reports, const RunInfo& run, double seconds);

/// One row a protocol; there is at least one.
Table protocols_table(const std::vector<ProtocolReport>& reports);

/// What each ground truth is, in words: a line a protocol.
std::string protocols_notes(const std::vector<ProtocolReport>& reports);

}  // namespace vpr
