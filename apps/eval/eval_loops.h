// vpr-eval --loops: the loop closures of any SLAM system against one trajectory.
#pragma once

#include <string>

#include "common/command.h"
#include "ground_truth/loop_list.h"

namespace vpr {

struct EvalInputs;

struct LoopInputs {
  std::string path;   ///< of the list
  std::string times;  ///< of a trajectory without times
  std::string gap;
  LoopFrames frames = LoopFrames::automatic;
};

/// Whether any of its flags is given.
bool is_given(const LoopInputs& inputs);

void add_loop_options(const Command& app, LoopInputs& inputs);

/// Judges the list and writes what was asked for. Throws Error(usage) for flags that belong to
/// other evaluations or are missing, and as read_loop_list and read_trajectory do.
void run_loops(Session& session, const EvalInputs& inputs);

}  // namespace vpr
