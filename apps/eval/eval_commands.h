// Subcommands of vpr-eval: check, convert, compare and report.
#pragma once

#include <string>
#include <vector>

#include "common/command.h"
#include "common/ground_truth_flags.h"
#include "present/table.h"

namespace vpr {

/// Numbers of frames. All empty: the ground truth itself has to state them.
struct ScopeInputs {
  std::string result;
  std::string query;
  std::vector<std::string> train;
  std::optional<uint64_t> query_frames;
  std::optional<uint64_t> train_frames;
};

struct CheckInputs {
  std::string ground_truth;
  GroundTruthFlags flags;
  ScopeInputs scope;
  TableFormat format = TableFormat::text;
};

/// `inputs` must live as long as the program.
void add_check(Program& program, CheckInputs& inputs);

struct ConvertInputs {
  std::string ground_truth;
  std::string target;
  GroundTruthFlags flags;
  ScopeInputs scope;
};

/// `inputs` must live as long as the program.
void add_convert(Program& program, ConvertInputs& inputs);

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
