// Tables of vpr-eval: one report, several results, or one result under several protocols.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "eval_inputs.h"
#include "present/table.h"

namespace vpr {

/// All tables of the reports, one below the other; of several, rows of one kind stand in one table,
/// each with its name from `names`. CSV is one table, whatever the reports are of.
std::string report_text(const std::vector<Json>& reports, const std::vector<std::string>& names,
                        TableFormat format);

/// A table with a row for each of the results, and vpr.reports/1. Throws Error(usage) for what
/// takes one result only.
void run_several(Session& session, const EvalInputs& inputs);

/// A table with a row for each of the presets that --protocol names, and vpr.protocols/1. Throws
/// Error(usage) for an unknown one, or what goes with one protocol only.
void run_protocols(Session& session, const EvalInputs& inputs);

}  // namespace vpr
