// Expected values of a report, for jobs that must fail when a number changes.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"

namespace vpr {

struct CheckedValue {
  std::string key;       ///< as in counts.pairs.correct
  std::string expected;  ///< "49 +- 2", "at least 60"
  std::string found;     ///< as JSON; a number with its difference, as in "52 (+3)"
  bool is_met = false;
};

/// Compares a report with `expected`, which is one of:
/// - a "vpr.expected/5" file with any part of "counts", "best_match", "metrics" and "localization"
///   (numbers), of "settings" and of "protocol";
/// - a whole earlier report, whose numbers, settings, tolerance and fingerprint of the ground truth
///   (without one, its description) are expected, but not the name of a score matrix.
/// A number must be equal; for {"value": 52, "tolerance": 2}, within the tolerance; for {"min": 50,
/// "max": 60} or one of the two, within these bounds; all bounds are inclusive. A setting must be
/// equal. Returns one entry per value, numbers first, in the order of the file. Throws
/// Error(usage), beginning with `where`, if `expected` has another format, expects nothing, or
/// names a number that the report does not have.
std::vector<CheckedValue> check_expectations(const Json& report, const Json& expected,
                                             const std::string& where);

/// One line per value that is not met: "KEY: expected ..., found ...".
std::vector<std::string> unmet_expectations(const std::vector<CheckedValue>& values);

/// `expected` with the values of the report: numbers are replaced and keep their tolerances, bounds
/// that are not met move to the number, settings and parts of the protocol are replaced. An earlier
/// report is replaced as a whole. Throws as check_expectations does.
Json updated_expectations(const Json& report, const Json& expected, const std::string& where);

}  // namespace vpr
