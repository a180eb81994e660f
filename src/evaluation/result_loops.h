// What a walk against its own past found, as a list of loop closures.
#pragma once

#include <string>
#include <vector>

#include "ground_truth/loop_list.h"
#include "recognition/result.h"

namespace vpr {

/// Whether the result is one of a walk against its own past alone.
bool has_loops(const Result& result);

/// The best match of each query window, as last frames of both and the score a frame; where a
/// threshold or a margin was set, those that are hits. Of FAB-MAP all, by probability. Lines are
/// those of loops_csv. The result has_loops().
std::vector<ListedLoop> loops_of(const Result& result);

/// The same as a list under a name, for a trajectory. Throws Error(data) for a result that has no
/// loops, or has not as many frames as the trajectory poses, and for a loop of a frame without one.
LoopList loop_list_of(const Result& result, const std::string& name, const Trajectory& trajectory);

/// As `vpr-eval --loops` reads it: the header query,match,score, and a line a loop.
std::string loops_csv(const std::vector<ListedLoop>& loops);

}  // namespace vpr
