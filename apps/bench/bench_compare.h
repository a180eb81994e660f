// vpr-bench compare: two runs on one machine.
#pragma once

#include <string>

#include "common/command.h"
#include "report/table.h"

namespace vpr {

struct CompareInputs {
  std::string older;
  std::string newer;
  double factor = 1.2;
  TableFormat format = TableFormat::text;
};

/// `inputs` and `none` must live as long as the program.
void add_compare(Program& program, CompareInputs& inputs, NoSettings& none);

}  // namespace vpr
