// Reports as JSON: of one result (vpr.report/4), of several results (vpr.reports/4), and of one
// result under several protocols (vpr.protocols/4).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "files/report.h"
#include "truth/formats.h"

namespace vpr {

/// The file without "machine" and "timing". Numbers that need a ground truth, or any verdict, are
/// absent without one.
Json report_json(const Report& report);
Json report_json(const Report& report, const RunInfo& run, double seconds);

/// Throws Error(usage) for a report without ground truth, and Error(data) for any other file and
/// for damage. `where`: the name of the file in messages.
Report parse_report(const Json& json, const std::string& where);

/// A letter per query frame: c(orrect), w(rong), i(gnored), u(nanswered); W, I and U for frames
/// without a match in the ground truth.
std::string outcome_letters(const Outcomes& outcomes);

Json curve_numbers_json(const Curve& curve);
Json curve_json(const Curve& curve);

/// "counts" of a report, and of a cell of a sweep.
Json counts_json(const Counts& counts);

/// `names`: one per report.
Json reports_json(std::span<const Report> reports, const std::vector<std::string>& names,
                  const RunInfo& run, double seconds);

/// The report of a result with the ground truth of a preset.
struct ProtocolReport {
  const GroundTruthPreset* preset = nullptr;
  Report report;
};

Json protocols_json(const std::vector<ProtocolReport>& reports, const RunInfo& run, double seconds);

}  // namespace vpr
