// vpr-eval of several results, and of one result under several protocols: a row for each.
#pragma once

#include "eval_inputs.h"

namespace vpr {

/// A table with a row for each of the results, and vpr.reports/1. Throws Error(usage) for what
/// takes one result only.
void run_several(Session& session, const EvalInputs& inputs);

/// A table with a row for each of the presets that --protocol names, and vpr.protocols/1. Throws
/// Error(usage) for an unknown one, or what goes with one protocol only.
void run_protocols(Session& session, const EvalInputs& inputs);

}  // namespace vpr
