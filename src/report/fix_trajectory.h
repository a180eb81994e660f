// Recognitions as a trajectory, for tools that compare trajectories.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ground_truth/route.h"

namespace vpr {

struct Evaluation;

/// Positions of training frames (of FAB-MAP: of places, as one sequence), by sequence of the scope
/// and frame; an empty list where those of a sequence are not known.
using TrainPositions = std::vector<std::vector<std::optional<RoutePoint>>>;

/// A line "time x y 0 0 0 0 1" (the TUM format) for each query frame that has a fix, right or
/// wrong, and whose match has a position: where somebody is told to be. Time is the frame's number,
/// by `frames_per_second` (above 0) in seconds. Positions are in metres, orientations not known.
/// The first line is a comment.
std::string fix_trajectory(const Evaluation& evaluation, const TrainPositions& positions,
                           std::optional<double> frames_per_second);

}  // namespace vpr
