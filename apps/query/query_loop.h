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

/// Throws Error(usage) for flags that only --loop has, without it, and beside it for a database of
/// sequences and what such a walk has no answer to.
void check_loop_inputs(const QueryInputs& inputs, const SequenceQuerySettings& settings);

/// The walk, described; settings.descriptor gets its name. Throws what describe_frames throws, and
/// Error(data) for times that are not as many as frames.
LoopWalk describe_loop(const SequenceArgument& walk, const QueryInputs& inputs,
                       SequenceQuerySettings& settings, const Session& session);

/// Writes the list of --save-loops, if any.
void write_loops(const QueryInputs& inputs, const Result& result, const Session& session);

}  // namespace vpr
