// vpr-eval check: is a ground truth sound?
#pragma once

#include "common/ground_truth_flags.h"
#include "report/table.h"
#include "scope_inputs.h"

namespace vpr {

struct CheckInputs {
  std::string ground_truth;
  GroundTruthFlags flags;
  ScopeInputs scope;
  TableFormat format = TableFormat::text;
};

/// `inputs` must live as long as the program.
void add_check(Program& program, CheckInputs& inputs);

}  // namespace vpr
