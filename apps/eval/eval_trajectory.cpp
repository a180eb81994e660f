#include "eval_trajectory.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "ground_truth/association.h"
#include "ground_truth/dataset.h"
#include "ground_truth/gps.h"
#include "ground_truth/route.h"
#include "ground_truth/times.h"
#include "report/fix_trajectory.h"

namespace vpr {
namespace {

Poses plan_poses(const std::vector<RoutePoint>& points) {
  Poses poses;
  for (const RoutePoint& point : points) poses.push_back(Pose{{point.x, point.y, 0}, {}, {}});
  return poses;
}

/// Where sequences of one map are: all in metres, or all on the earth and put on the plane that
/// touches it where the first frame was taken.
class OneMap {
 public:
  Poses add(TrainPoses train) {
    if (train.poses.empty()) return {};
    if (is_on_earth_.value_or(train.is_on_earth) != train.is_on_earth)
      throw Error(ErrorKind::data,
                  "--fixes-tum: some training sequences have latitudes and longitudes and others "
                  "metres; give all in one way");
    is_on_earth_ = train.is_on_earth;
    for (auto& pose : train.poses)
      if (pose && train.is_on_earth) pose->position = on_plane(pose->position);
    return std::move(train.poses);
  }

 private:
  std::array<double, 3> on_plane(const std::array<double, 3>& earth) {
    if (!plane_) plane_.emplace(earth);
    return plane_->local(earth);
  }

  std::optional<bool> is_on_earth_;
  std::optional<LocalPlane> plane_;
};

// Where the frames of each sequence were taken, as the data set says it or else the ground truth;
// of a sequence that is thinned, those of the frames that are kept.
TrainPositions read_positions(const Dataset& dataset, const Evaluation& evaluation,
                              const GroundTruthOptions& options, const Monitor& monitor) {
  if (evaluation.result && evaluation.result->result.places)
    return {dataset.place_poses.empty() ? Poses{}
                                        : plan_poses(read_place_positions(dataset.place_poses))};
  TrainPositions positions;
  OneMap map;
  for (const auto& sequence : evaluation.judgement.layout.scope.sequences) {
    Poses& poses = positions.emplace_back();
    const auto train = std::ranges::find(dataset.train, sequence.name, &NamedSequence::name);
    if (train != dataset.train.end() && !train->poses.empty())
      poses = map.add(read_train_poses(train->poses, {}, monitor));
    else if (!options.reference.empty() && sequence.searched)
      poses = map.add(read_train_poses(options.reference, options, monitor));
    if (!sequence.kept || poses.empty()) continue;
    poses.resize(sequence.kept->recorded_frames);
    poses = replayed(poses, *sequence.kept);
  }
  return positions;
}

FrameClock clock_of(const Evaluation& evaluation, const GroundTruthOptions& options,
                    std::optional<double> frames_per_second, const Monitor& monitor) {
  FrameClock clock{{}, frames_per_second};
  const auto& replay = evaluation.judgement.layout.scope.replay;
  if (replay && !replay->warp.empty()) return clock;  // whose frames have no times
  if (replay) clock.sources = replay->sources;
  if (!options.query_times.empty()) clock.times_ns = read_frame_times(options.query_times, monitor);
  return clock;
}

}  // namespace

void add_trajectory_options(const Command& app, TrajectoryInputs& inputs) {
  app.add_option("--fixes-tum", inputs.file,
                 "write where each recognised frame is said to be as a TUM trajectory (time x y z "
                 "qx qy qz qw), as for evo; needs poses of training frames: --dataset, or "
                 "--ground-truth-reference")
      .type_name("FILE");
}

void claim_trajectory(const Session& session, const TrajectoryInputs& inputs, bool has_positions) {
  if (inputs.file.empty()) return;
  if (!has_positions)
    throw Error(ErrorKind::usage,
                "--fixes-tum needs to know where training frames were taken: by --dataset, whose "
                "\"poses\" say it, or by --ground-truth-reference");
  session.outputs.claim_file(inputs.file);
}

void write_trajectory(const Session& session, const TrajectoryInputs& inputs,
                      const std::string& dataset, const Evaluation& evaluation,
                      const std::optional<GroundTruthArgument>& truth,
                      std::optional<double> frames_per_second) {
  if (inputs.file.empty()) return;
  const GroundTruthOptions options = truth ? truth->options : GroundTruthOptions{};
  const TrainPositions positions = read_positions(
      dataset.empty() ? Dataset{} : read_dataset(dataset), evaluation, options, session.monitor);
  if (std::ranges::all_of(positions, [](const auto& frames) { return frames.empty(); }))
    throw Error(ErrorKind::usage,
                fmt::format("{}: no training sequence that was searched names \"poses\", which "
                            "--fixes-tum needs (of FAB-MAP \"place_poses\")",
                            dataset));
  const FrameClock clock = clock_of(evaluation, options, frames_per_second, session.monitor);
  session.outputs.file(inputs.file).write(fix_trajectory(evaluation, positions, clock));
}

}  // namespace vpr
