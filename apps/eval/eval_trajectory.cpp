#include "eval_trajectory.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "ground_truth/dataset.h"
#include "ground_truth/frame_times.h"
#include "report/fix_trajectory.h"

namespace vpr {
namespace {

TrainPositions read_positions(const Dataset& dataset, const Evaluation& evaluation) {
  TrainPositions positions;
  if (evaluation.result && evaluation.result->result.places) {
    positions.emplace_back();
    if (!dataset.place_poses.empty())
      for (const RoutePoint& place : read_place_positions(dataset.place_poses))
        positions.back().emplace_back(place);
    return positions;
  }
  for (const auto& sequence : evaluation.judgement.layout.scope.sequences) {
    positions.emplace_back();
    const auto train = std::ranges::find(dataset.train, sequence.name, &NamedSequence::name);
    if (train != dataset.train.end() && !train->poses.empty())
      positions.back() = read_route(train->poses);
  }
  return positions;
}

}  // namespace

void add_trajectory_options(const Command& app, TrajectoryInputs& inputs) {
  app.add_option("--fixes-tum", inputs.file,
                 "write where each recognised frame is said to be as a TUM trajectory (time x y z "
                 "qx qy qz qw), as for evo; needs --dataset with poses of training frames")
      .type_name("FILE");
}

void claim_trajectory(const Session& session, const TrajectoryInputs& inputs,
                      const std::string& dataset) {
  if (inputs.file.empty()) return;
  if (dataset.empty())
    throw Error(
        ErrorKind::usage,
        "--fixes-tum needs --dataset, whose \"poses\" say where training frames were taken");
  session.outputs.claim_file(inputs.file);
}

void write_trajectory(const Session& session, const TrajectoryInputs& inputs,
                      const std::string& dataset, const Evaluation& evaluation,
                      const std::optional<GroundTruthArgument>& truth,
                      std::optional<double> frames_per_second) {
  if (inputs.file.empty()) return;
  const TrainPositions positions = read_positions(read_dataset(dataset), evaluation);
  if (std::ranges::all_of(positions, [](const auto& frames) { return frames.empty(); }))
    throw Error(ErrorKind::usage,
                fmt::format("{}: no training sequence that was searched names \"poses\", which "
                            "--fixes-tum needs (CSV frame,x,y; of FAB-MAP \"place_poses\")",
                            dataset));
  FrameClock clock{{}, frames_per_second};
  const bool is_replayed = evaluation.judgement.layout.scope.replay.has_value();
  if (truth && !truth->options.query_times.empty() && !is_replayed)
    clock.times_ns = read_frame_times(truth->options.query_times, session.monitor);
  session.outputs.file(inputs.file).write(fix_trajectory(evaluation, positions, clock));
}

}  // namespace vpr
