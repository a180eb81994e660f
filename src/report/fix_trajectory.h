// Recognitions as a trajectory, for tools that compare trajectories.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ground_truth/route.h"

namespace vpr {

struct Evaluation;

/// Positions of training frames (of FAB-MAP: of places, as one sequence), by sequence of the scope
/// and frame; an empty list where those of a sequence are not known.
using TrainPositions = std::vector<std::vector<std::optional<RoutePoint>>>;

/// When query frames were taken: the times of all of them in nanoseconds, or, where there are none,
/// numbers of frames by frames_per_second (above 0), or as they are.
struct FrameClock {
  std::vector<int64_t> times_ns;
  std::optional<double> frames_per_second;
};

/// A line "time x y 0 0 0 0 1" (the TUM format) for each query frame that has a fix, right or
/// wrong, and whose match has a position: where somebody is told to be. Positions are in metres,
/// orientations not known. The first line is a comment.
std::string fix_trajectory(const Evaluation& evaluation, const TrainPositions& positions,
                           const FrameClock& clock);

}  // namespace vpr
