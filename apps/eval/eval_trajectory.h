// --fixes-tum of vpr-eval.
#pragma once

#include <optional>
#include <string>

#include "common/command.h"
#include "pipeline/evaluate.h"

namespace vpr {

struct TrajectoryInputs {
  std::string file;  ///< empty: not asked for
};

void add_trajectory_options(const Command& app, TrajectoryInputs& inputs);

/// Claims the output. Throws Error(usage) unless something has positions of training frames: a data
/// set, or poses of a ground truth. Call it before long work.
void claim_trajectory(const Session& session, const TrajectoryInputs& inputs, bool has_positions);

/// Positions are of the data set's poses, or of the ground truth's, in any format of trajectories.
/// Times are those of --query-times, where the query is judged by them and is not replayed. Throws
/// Error(usage) if nothing has positions of training frames, and as read_train_poses and
/// read_frame_times do.
void write_trajectory(const Session& session, const TrajectoryInputs& inputs,
                      const std::string& dataset, const Evaluation& evaluation,
                      const std::optional<GroundTruthArgument>& truth,
                      std::optional<double> frames_per_second);

}  // namespace vpr
