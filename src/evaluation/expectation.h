// Expected counts, for jobs that must fail when a number changes.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"

namespace vpr {

/// Compares a report with `expected`: a "vpr.expected/1" file with any part of "counts",
/// "best_match", "metrics" and "localisation" (numbers), of "settings" and of "protocol", or a
/// whole earlier report. Of that the numbers count, the settings, the tolerance of the ground truth
/// and its fingerprint (of older reports, its words); the name of a score matrix does not. A number
/// is met exactly, or, written {"value": 52, "tolerance": 2}, within the tolerance, bounds
/// included; a setting is met exactly. Returns one line per value that differs, numbers first.
/// Throws Error(usage) if `expected` (named by `where`) is not such a file, expects nothing, or
/// names a number that the report does not have.
std::vector<std::string> unmet_expectations(const Json& report, const Json& expected,
                                            const std::string& where);

}  // namespace vpr
