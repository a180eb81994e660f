// vpr-eval compare: reports of several methods on the same queries.
#pragma once

#include <string>
#include <vector>

#include "common/command.h"
#include "report/table.h"

namespace vpr {

struct CompareInputs {
  std::vector<std::string> reports;
  std::vector<std::string> names;  ///< given by --name, or none
  uint64_t block = 0;              ///< 0: chosen from the windows
  bool allow_different = false;    ///< ground truths
  std::string html;                ///< a file; empty: not asked for
  std::string plots;               ///< a folder; empty: not asked for
  TableFormat format = TableFormat::text;
};

/// `inputs` must live as long as the program.
void add_compare(Program& program, CompareInputs& inputs);

}  // namespace vpr
