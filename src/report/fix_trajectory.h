// Recognitions as a trajectory, for tools that compare trajectories.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ground_truth/poses.h"

namespace vpr {

struct Evaluation;

/// Positions of training frames (of FAB-MAP: of places, as one sequence), by sequence of the scope
/// and frame; an empty list where those of a sequence are not known.
using TrainPositions = std::vector<Poses>;

/// When query frames were taken: the times of all of them in nanoseconds, or, where there are none,
/// numbers of frames by frames_per_second (above 0), or as they are. Of a query that is thinned,
/// these are the recording's frames, of which `sources` has one a query frame; empty otherwise.
struct FrameClock {
  std::vector<int64_t> times_ns;
  std::optional<double> frames_per_second;
  std::vector<uint32_t> sources = {};
};

/// A line "time x y z 0 0 0 1" (the TUM format) for each query frame that has a fix, right or
/// wrong, and whose match has a position: where somebody is told to be. Positions are in metres
/// (z is 0 on a plan), orientations not known. The first line is a comment.
std::string fix_trajectory(const Evaluation& evaluation, const TrainPositions& positions,
                           const FrameClock& clock);

}  // namespace vpr
