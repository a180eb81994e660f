#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "eval.h"
#include "evaluate/prediction_lists.h"
#include "files/exports.h"
#include "truth/positions.h"
#include "truth/times.h"
#include "truth/trajectory.h"

namespace vpr {
namespace {

// Positions of training frames in meters, from the data set or else from the ground truth.
TrainPositions read_positions(const Dataset& dataset, const Evaluation& evaluation,
                              const GroundTruthOptions& options, const Monitor& monitor) {
  TrainPositions positions;
  if (evaluation.result && evaluation.result->result->places) {
    Poses& places = positions.emplace_back();
    if (dataset.place_poses.empty()) return positions;
    for (const RoutePoint& point : read_place_positions(dataset.place_poses))
      places.push_back(Pose{{point.x, point.y, 0}, {}, {}});
    return positions;
  }
  std::optional<bool> is_on_earth;
  std::optional<LocalPlane> plane;  // tangent at the first frame
  const auto read = [&](const std::filesystem::path& path, const GroundTruthOptions& times) {
    Trajectory train = read_train_poses(path, times, monitor);
    if (train.poses.empty()) return train.poses;
    if (is_on_earth.value_or(train.is_on_earth) != train.is_on_earth)
      throw Error(ErrorKind::data,
                  "--save-trajectory: some training sequences have latitudes and longitudes, "
                  "others have meters. Use the same for all");
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
  if (!selection.speed.empty()) return clock;  // its frames have no times
  clock.sources = selection.sources;
  if (options.query_times.empty()) return clock;
  clock.times_ns = read_frame_times(options.query_times, monitor);
  if (clock.times_ns.size() < evaluation.query().recorded_frames())
    throw Error(ErrorKind::data, "{}: has {}, the query has {}", options.query_times.string(),
                counted(clock.times_ns.size(), "time"),
                counted(evaluation.query().recorded_frames(), "frame"));
  return clock;
}

std::string name_of(const std::vector<std::string>& names, size_t frame) {
  if (names.empty()) return std::to_string(frame);
  if (frame >= names.size())
    throw Error(
        ErrorKind::usage,
        "there is no name for frame {}, only for {}. Pass the sequences that were evaluated", frame,
        counted(names.size(), "frame"));
  return names[frame];
}

}  // namespace

void CsvTables::add(const EvalInputs& inputs, const Evaluation& evaluation,
                    const std::string& name) {
  if (!inputs.outcomes_csv.empty())
    outcomes_ += outcomes_csv(evaluation.judgment, name, evaluation.query().name);
  if (!inputs.recognitions_csv.empty() && evaluation.result)
    recognitions_ += recognitions_csv(*evaluation.result, name);
}

void CsvTables::write(const Session& session, const EvalInputs& inputs) const {
  if (!inputs.outcomes_csv.empty())
    session.outputs.file(inputs.outcomes_csv).write(outcomes_csv_header() + outcomes_);
  if (!inputs.recognitions_csv.empty())
    session.outputs.file(inputs.recognitions_csv).write(recognitions_csv_header() + recognitions_);
}

std::string output_text(const Session& session, TableFormat format, const std::string& brief,
                        const std::string& tables) {
  if (format != TableFormat::text) return tables;
  return session.options.verbose ? brief + "\n" + tables : brief;
}

void write_trajectory(const Session& session, const EvalInputs& inputs, const Evaluated& evaluated,
                      std::optional<double> frames_per_second) {
  if (inputs.saved_trajectory.empty()) return;
  const auto& [evaluation, by, report, run] = evaluated;
  const GroundTruthOptions options =
      by.ground_truth ? by.ground_truth->options : GroundTruthOptions{};
  const TrainPositions positions =
      read_positions(inputs.truth.dataset.empty() ? Dataset{} : read_dataset(inputs.truth.dataset),
                     evaluation, options, session.monitor);
  if (std::ranges::all_of(positions, [](const Poses& frames) { return frames.empty(); }))
    throw Error(ErrorKind::usage,
                "--save-trajectory: no searched training sequence has \"poses\" (FAB-MAP: "
                "\"place_poses\") in the data set, or poses of --ground-truth-train");
  const FrameClock clock = clock_of(evaluation, options, frames_per_second, session.monitor);
  session.outputs.file(inputs.saved_trajectory)
      .write(recognized_trajectory(evaluation, positions, clock));
}

size_t write_pairs(const Session& session, const EvalInputs& inputs, const ScoreMatrix* matrix,
                   const ScoreLayout& layout, const Result* result) {
  constexpr uint64_t kDefaultPairs = 10;  // of scores
  if (inputs.pairs.empty()) return 0;
  assert(matrix != nullptr || result != nullptr);
  const std::vector<BestPair> pairs =
      matrix == nullptr
          ? best_pairs(*result)
          : best_pairs(*matrix, layout, inputs.top_k.value_or(result ? 1 : kDefaultPairs),
                       session.monitor);
  const size_t sequences = layout.scope.sequences.size();
  const std::vector<std::string> query = query_names(inputs);
  std::vector<std::vector<std::string>> train = train_names(inputs);
  if (sequences > 1 && train.size() < sequences)
    throw Error(ErrorKind::usage,
                "--pairs: name the frames of all {} training sequences, in the order of the "
                "database, with --train",
                sequences);
  train.resize(std::max(train.size(), sequences));
  const auto has_blank = [](const std::vector<std::string>& names) {
    return std::ranges::any_of(names, [](const std::string& name) {
      return name.find_first_of(" ,\t") != std::string::npos;
    });
  };
  const bool has_blanks = has_blank(query) || std::ranges::any_of(train, has_blank);
  std::string text;
  for (const BestPair& pair : pairs) {
    const std::string left = name_of(query, pair.query);
    const std::string right = name_of(train[pair.match.sequence], pair.match.reference);
    text += has_blanks ? fmt::format("{},{}\n", csv_field(left), csv_field(right))
                       : fmt::format("{} {}\n", left, right);
  }
  session.outputs.file(inputs.pairs).write(text);
  return pairs.size();
}

}  // namespace vpr
