// vpr-eval --protocol: one result under several protocols.
#pragma once

#include <functional>
#include <string>

#include "base/json_fwd.h"
#include "common/command.h"
#include "report/table.h"

namespace vpr {

/// `evaluate` gives the report (without "machine") of the result for a ground truth of that name.
/// Prints a table with a row for each of the presets in `protocols`, and writes and prints
/// vpr.protocols/1. Throws Error(usage) for an unknown one.
void evaluate_protocols(Session& session, const std::string& protocols, const std::string& result,
                        TableFormat format,
                        const std::function<Json(const std::string& ground_truth)>& evaluate);

}  // namespace vpr
