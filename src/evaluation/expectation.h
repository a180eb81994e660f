// Expected counts, for jobs that must fail when a number changes.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"

namespace vpr {

/// Compares numbers of a report with those of `expected`: a "vpr.expected/1" file with any part of
/// "counts", "best_match", "metrics" and "localisation", or a whole earlier report (of which these
/// count). A number is met
/// exactly, or, written {"value": 52, "tolerance": 2}, within the tolerance, bounds included.
/// Returns one line per number that differs, in the order of `expected`. Throws Error(usage) if
/// `expected` (named by `where`) is not such a file, expects nothing, or names a number that the
/// report does not have.
std::vector<std::string> unmet_expectations(const Json& report, const Json& expected,
                                            const std::string& where);

}  // namespace vpr
