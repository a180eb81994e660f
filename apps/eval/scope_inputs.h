// Numbers of frames, for commands that look at a ground truth without a result.
#pragma once

#include <string>
#include <vector>

#include "common/command.h"
#include "ground_truth/ground_truth.h"

namespace vpr {

/// All empty: the ground truth itself has to say.
struct ScopeInputs {
  std::string result;
  std::string query;
  std::vector<std::string> train;
  std::optional<uint64_t> query_frames;
  std::optional<uint64_t> train_frames;
};

void add_scope_flags(const Command& command, ScopeInputs& inputs);

/// Videos are read to count their frames. Throws Error(usage) if more than one source is given, or
/// only one side.
GroundTruthScope find_scope(const ScopeInputs& inputs, const Monitor& monitor);

}  // namespace vpr
