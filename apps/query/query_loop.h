// vpr-query --loop: a walk against its own past.
#pragma once

#include <vector>

#include "query_inputs.h"

namespace vpr {

/// What a walk is compared with: itself.
struct LoopWalk {
  SequenceDatabase database;
  DescriptorSet query;
  std::vector<int64_t> times_ns;  ///< where the gap is one of time
};

/// The walk, described. Throws what describe_frames throws, and
/// Error(data) for times that are not as many as frames.
LoopWalk describe_loop(const SequenceArgument& walk, const QueryInputs& inputs,
                       const SequenceQuerySettings& settings, const Session& session);

/// Writes the list of --save-loops, if any.
void write_loops(const QueryInputs& inputs, const Result& result, const Session& session);

}  // namespace vpr
