#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"
#include "eval_inputs.h"
#include "present/exports.h"
#include "truth/association.h"
#include "truth/dataset.h"
#include "truth/gps.h"
#include "truth/route.h"
#include "truth/times.h"

namespace vpr {

namespace {

Poses plan_poses(const std::vector<RoutePoint>& points) {
  Poses poses;
  for (const RoutePoint& point : points) poses.push_back(Pose{{point.x, point.y, 0}, {}, {}});
  return poses;
}

// Positions of the frames of each sequence, from the data set or else the ground truth; of a
// thinned sequence, those of its kept frames. All are in meters on one map.
TrainPositions read_positions(const Dataset& dataset, const Evaluation& evaluation,
                              const GroundTruthOptions& options, const Monitor& monitor) {
  if (evaluation.result && evaluation.result->result.places)
    return {dataset.place_poses.empty() ? Poses{}
                                        : plan_poses(read_place_positions(dataset.place_poses))};
  TrainPositions positions;
  std::optional<bool> is_on_earth;
  std::optional<LocalPlane> plane;  // touches the earth at the first frame
  const auto read = [&](const std::filesystem::path& path, const GroundTruthOptions& times) {
    TrainPoses train = read_train_poses(path, times, monitor);
    if (train.poses.empty()) return train.poses;
    if (is_on_earth.value_or(train.is_on_earth) != train.is_on_earth)
      throw Error(ErrorKind::data,
                  "--fixes-tum: some training sequences have latitudes and longitudes and others "
                  "meters; give all in one way");
    is_on_earth = train.is_on_earth;
    for (auto& pose : train.poses) {
      if (!pose || !train.is_on_earth) continue;
      if (!plane) plane.emplace(pose->position);
      pose->position = plane->local(pose->position);
    }
    return train.poses;
  };
  for (const auto& [sequence, searched, names] : evaluation.judgment.layout.scope.sequences) {
    Poses& poses = positions.emplace_back();
    const auto train = std::ranges::find(dataset.train, sequence.name, &NamedSequence::name);
    if (train != dataset.train.end() && !train->poses.empty())
      poses = read(train->poses, {});
    else if (!options.reference.empty() && searched)
      poses = read(options.reference, options);
    if (sequence.selection.is_all() || poses.empty()) continue;
    poses.resize(sequence.recorded_frames());
    poses = selected(std::move(poses), sequence.selection);
  }
  return positions;
}

FrameClock clock_of(const Evaluation& evaluation, const GroundTruthOptions& options,
                    std::optional<double> frames_per_second, const Monitor& monitor) {
  FrameClock clock{{}, frames_per_second};
  const Selection& selection = evaluation.query().selection;
  if (!selection.warp.empty()) return clock;  // whose frames have no times
  clock.sources = selection.sources;
  if (!options.query_times.empty()) clock.times_ns = read_frame_times(options.query_times, monitor);
  return clock;
}

}  // namespace

void add_csv_options(const Command& app, CsvInputs& inputs) {
  app.add_option("--outcomes-csv", inputs.outcomes,
                 "write a row for every query: its best match and whether that is right")
      .type_name("FILE");
  app.add_option(
         "--recognitions-csv", inputs.recognitions,
         "write a row for every recognized place: frames, recognitions and whether it is right")
      .type_name("FILE");
}

void claim_csv_outputs(const Session& session, const CsvInputs& inputs, bool has_result) {
  if (!inputs.outcomes.empty()) session.outputs.claim_file(inputs.outcomes);
  if (inputs.recognitions.empty()) return;
  session.outputs.claim_file(inputs.recognitions);
  if (!has_result)
    throw Error(ErrorKind::usage,
                "--recognitions-csv lists the recognitions of a result of vpr-query; scores have "
                "--outcomes-csv");
}

void add_rows(CsvRows& rows, const CsvInputs& inputs, const Evaluation& evaluation,
              const std::string& name) {
  if (!inputs.outcomes.empty())
    rows.outcomes += outcomes_csv(evaluation.judgment, name, evaluation.query().name);
  if (!inputs.recognitions.empty() && evaluation.result)
    rows.recognitions += recognitions_csv(*evaluation.result, name);
}

void write_csv_rows(const Session& session, const CsvInputs& inputs, const CsvRows& rows) {
  if (!inputs.outcomes.empty()) session.outputs.file(inputs.outcomes).write(rows.outcomes);
  if (!inputs.recognitions.empty())
    session.outputs.file(inputs.recognitions).write(rows.recognitions);
}

void add_expect_options(const Command& app, ExpectInputs& inputs) {
  app.add_option("--expect", inputs.expected,
                 "compare with a vpr.expected/1 file (numbers, with \"tolerance\", or \"min\" and "
                 "\"max\") or an earlier report; exit code 5 if they differ")
      .type_name("FILE");
  app.add_flag("--update", inputs.update,
               "the file of --expect takes over what is found (tolerances stay, and bounds that "
               "are met); where there is none, the report becomes it");
  app.add_option("--junit", inputs.junit,
                 "write what --expect finds as JUnit XML, a test case for each value")
      .type_name("FILE");
}

Json read_expected(const Session& session, const ExpectInputs& inputs) {
  if (inputs.expected.empty()) {
    if (inputs.update || !inputs.junit.empty())
      throw Error(ErrorKind::usage, fmt::format("{} needs --expect, the file of what is expected",
                                                inputs.update ? "--update" : "--junit"));
    return {};
  }
  if (!inputs.junit.empty()) session.outputs.claim_file(inputs.junit);
  std::error_code error;
  const bool exists = std::filesystem::exists(inputs.expected, error);
  const bool is_new = inputs.update && !exists;
  if (inputs.update) {
    if (!is_new) session.outputs.extend(inputs.expected);
    session.outputs.claim_file(inputs.expected);
  }
  if (!inputs.update && !exists)
    throw Error(ErrorKind::input, fmt::format("{}: no such file. With --update it is made from "
                                              "this report",
                                              inputs.expected));
  return is_new ? Json() : read_json(inputs.expected, ErrorKind::usage);
}

std::vector<CheckedValue> check_expected(const Session& session, const ExpectInputs& inputs,
                                         const Json& expected, const Json& report) {
  if (inputs.expected.empty()) return {};
  const Json& compared = expected.is_null() ? report : expected;
  std::vector<CheckedValue> values = check_expectations(report, compared, inputs.expected);
  if (!inputs.junit.empty()) {
    const std::string suite = fmt::format("{} on {}", report["method"].get<std::string>(),
                                          report["query"].get<std::string>());
    session.outputs.file(inputs.junit).write(junit_xml(suite, inputs.expected, values));
  }
  if (inputs.update) {
    const Json updated = updated_expectations(report, compared, inputs.expected);
    session.outputs.file(inputs.expected).write(to_text(updated));
  }
  return values;
}

std::string met_sentence(const ExpectInputs& inputs, const std::vector<CheckedValue>& values) {
  if (values.empty()) return "";
  const size_t unmet = unmet_expectations(values).size();
  if (unmet == 0)
    return fmt::format("\n{}: all of {} met.\n", inputs.expected,
                       counted(values.size(), "expected value is", "expected values are"));
  if (!inputs.update) return "";  // the error says it
  return fmt::format("\n{}: updated; {} of {} were not met.\n", inputs.expected, unmet,
                     counted(values.size(), "expected value"));
}

void require_met(const ExpectInputs& inputs, const std::vector<CheckedValue>& values) {
  const std::vector<std::string> unmet = unmet_expectations(values);
  if (!unmet.empty() && !inputs.update)
    throw Error(ErrorKind::expectation,
                fmt::format("{}: not met:\n  {}", inputs.expected, fmt::join(unmet, "\n  ")));
}

void add_trajectory_options(const Command& app, EvalInputs& inputs) {
  app.add_option("--fixes-tum", inputs.fixes,
                 "write where each recognized frame is said to be as a TUM trajectory (time x y z "
                 "qx qy qz qw), as for evo; needs poses of training frames: --dataset, or "
                 "--ground-truth-reference")
      .type_name("FILE");
}

void claim_trajectory(const Session& session, const EvalInputs& inputs) {
  if (inputs.fixes.empty()) return;
  if (inputs.dataset.empty() && inputs.flags.options.reference.empty())
    throw Error(ErrorKind::usage,
                "--fixes-tum needs to know where training frames were taken: by --dataset, whose "
                "\"poses\" say it, or by --ground-truth-reference");
  session.outputs.claim_file(inputs.fixes);
}

void write_trajectory(const Session& session, const EvalInputs& inputs, const Evaluated& evaluated,
                      std::optional<double> frames_per_second) {
  if (inputs.fixes.empty()) return;
  const Evaluation& evaluation = evaluated.evaluation;
  const auto& truth = evaluated.by.ground_truth;
  const GroundTruthOptions options = truth ? truth->options : GroundTruthOptions{};
  const TrainPositions positions =
      read_positions(inputs.dataset.empty() ? Dataset{} : read_dataset(inputs.dataset), evaluation,
                     options, session.monitor);
  if (std::ranges::all_of(positions, [](const auto& frames) { return frames.empty(); }))
    throw Error(ErrorKind::usage,
                fmt::format("{}: no training sequence that was searched names \"poses\", which "
                            "--fixes-tum needs (of FAB-MAP \"place_poses\")",
                            inputs.dataset));
  const FrameClock clock = clock_of(evaluation, options, frames_per_second, session.monitor);
  session.outputs.file(inputs.fixes).write(fix_trajectory(evaluation, positions, clock));
}

}  // namespace vpr
