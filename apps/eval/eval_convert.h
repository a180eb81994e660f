// vpr-eval convert: a ground truth from one format to another.
#pragma once

#include "common/ground_truth_flags.h"
#include "scope_inputs.h"

namespace vpr {

struct ConvertInputs {
  std::string ground_truth;
  std::string target;
  GroundTruthFlags flags;
  ScopeInputs scope;
};

/// `inputs` must live as long as the program.
void add_convert(Program& program, ConvertInputs& inputs);

}  // namespace vpr
