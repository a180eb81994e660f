// Expected values, for jobs that must fail when a number changes.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"

namespace vpr {

/// One value that is expected of a report.
struct CheckedValue {
  std::string key;       ///< where it stands, as in counts.recognitions.correct
  std::string expected;  ///< "49 +- 2", "at least 60"
  std::string found;     ///< as JSON, with the difference to a number, as in "52 (+3)"
  bool is_met = false;
};

/// Compares a report with `expected`: a "vpr.expected/1" file with any part of "counts",
/// "best_match", "metrics" and "localization" (numbers), of "settings" and of "protocol", or a
/// whole earlier report. Of that the numbers count, the settings, the tolerance of the ground truth
/// and its fingerprint (without one, its words); the name of a score matrix does not. A number
/// is met exactly, or, written {"value": 52, "tolerance": 2}, within the tolerance, or, written
/// {"min": 50} or {"max": 60} or with both, from the one to the other, all bounds included; a
/// setting is met exactly. Returns an entry for each value, numbers first, in the file's order.
/// Throws Error(usage) if `expected` (named by `where`) is not such a file, expects nothing, or
/// names a number that the report does not have.
std::vector<CheckedValue> check_expectations(const Json& report, const Json& expected,
                                             const std::string& where);

/// A line for each value that is not met: "KEY: expected ..., found ...".
std::vector<std::string> unmet_expectations(const std::vector<CheckedValue>& values);

/// `expected` with what the report has: numbers are replaced and keep their tolerances, bounds that
/// are not met are moved to the number, and settings and parts of the protocol become the report's.
/// An earlier report becomes the report. Throws as check_expectations does.
Json updated_expectations(const Json& report, const Json& expected, const std::string& where);

}  // namespace vpr
