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

/// Claims the output. Throws Error(usage) without a data set. Call it before long work.
void claim_trajectory(const Session& session, const TrajectoryInputs& inputs,
                      const std::string& dataset);

/// Throws Error(usage) if the data set has no positions of training frames.
void write_trajectory(const Session& session, const TrajectoryInputs& inputs,
                      const std::string& dataset, const Evaluation& evaluation,
                      std::optional<double> frames_per_second);

}  // namespace vpr
