// vpr-eval report: all results and reports of a folder as one page.
#pragma once

#include <string>

#include "common/command.h"
#include "common/ground_truth_flags.h"
#include "report/table.h"

namespace vpr {

struct GridInputs {
  std::string folder;
  std::string dataset;       ///< by which results are judged; empty: none
  std::string ground_truth;  ///< likewise
  GroundTruthFlags flags;
  std::string html;  ///< a file; empty: not asked for
  TableFormat format = TableFormat::text;
};

/// `inputs` must live as long as the program.
void add_grid(Program& program, GridInputs& inputs);

}  // namespace vpr
