#include "ground_truth/poses.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "ground_truth/association.h"
#include "ground_truth/builder.h"
#include "ground_truth/numbers.h"
#include "ground_truth/pose_csv.h"
#include "ground_truth/pose_matches.h"
#include "ground_truth/trajectory.h"

namespace vpr {
namespace {

Poses read_csv_poses(const std::filesystem::path& path, const FrameCount& frames) {
  PoseCsvRules rules{frames.frames, kMostGrownFrames};
  if (frames.grows) rules.frames.reset();
  Poses poses;
  for (const auto& found : read_pose_csv(path, rules)) {
    poses.emplace_back();
    if (!found) continue;
    Pose& pose = poses.back().emplace();
    if (found->place)
      throw Error(ErrorKind::data,
                  fmt::format("{}: has latitudes and longitudes, which poses in metres can't be "
                              "compared with; give both sides so (format gps)",
                              path.string()));
    pose.position = found->position;
    pose.heading_deg = found->heading_deg;
  }
  return poses;
}

/// A trajectory, of whose times the second reader makes sure where they are asked for.
struct TrajectoryReaders {
  Trajectory (*without_times)(const std::filesystem::path& path);
  Trajectory (*with_times)(const std::filesystem::path& path);
};

const std::filesystem::path& training_path(const GroundTruthArgument& argument) {
  if (argument.options.reference.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: has the poses of the query; give those of the training sequence, "
                            "as in --ground-truth-reference POSES",
                            argument.path.string()));
  return argument.options.reference;
}

/// `read(side, path)` gives the poses of one side.
template <class Read>
std::string read_both(GroundTruthBuilder& builder, std::string_view format, Read&& read) {
  const GroundTruthArgument& argument = builder.argument();
  const size_t sequence = builder.only_searched(argument.path.string());
  const std::filesystem::path& reference = training_path(argument);
  builder.at_file(argument.path);  // for what is found out about the whole file
  const Poses query = read(PoseSide::query, argument.path);
  const GroundTruthOptions& options = argument.options;
  if (!options.query_times.empty()) builder.at_file(options.query_times);
  builder.require_query_frames(query.size());
  builder.at_file(reference);
  const Poses train = read(PoseSide::train, reference);
  if (!options.reference_times.empty()) builder.at_file(options.reference_times);
  builder.require_train_frames(sequence, train.size());
  return fmt::format("{} poses{}: {}", format, times_in_words(argument.options),
                     match_poses(builder, sequence, query, train));
}

std::string read_trajectories(GroundTruthBuilder& builder, std::string_view format,
                              const TrajectoryReaders& readers) {
  return read_both(builder, format, [&](PoseSide side, const std::filesystem::path& path) {
    const GroundTruthOptions& options = builder.argument().options;
    const bool has_times =
        !(side == PoseSide::query ? options.query_times : options.reference_times).empty();
    return poses_of_side(options, side,
                         (has_times ? readers.with_times : readers.without_times)(path),
                         builder.monitor());
  });
}

bool has_numbers(std::string_view line, size_t count) {
  const auto words = split_words(line);
  return words.size() == count && std::all_of(words.begin(), words.end(), [](std::string_view w) {
           return parse_real(w).has_value();
         });
}

}  // namespace

std::string read_poses(GroundTruthBuilder& builder) {
  return read_both(builder, "csv", [&](PoseSide side, const std::filesystem::path& path) {
    return read_csv_poses(path, side == PoseSide::query
                                    ? builder.query()
                                    : builder.train(builder.only_searched(path.string())));
  });
}

std::string read_tum_poses(GroundTruthBuilder& builder) {
  return read_trajectories(builder, "tum", {read_tum_without_times, read_tum});
}

std::string read_kitti_poses(GroundTruthBuilder& builder) {
  return read_trajectories(builder, "kitti", {read_kitti, read_kitti});
}

std::string read_euroc_poses(GroundTruthBuilder& builder) {
  return read_trajectories(builder, "euroc", {read_euroc, read_euroc});
}

bool is_pose_csv(const FileStart& start) {
  std::vector<std::string> names;
  for (std::string_view name : split(start.first_line, ',')) {
    if (name.size() >= 2 && name.front() == '"' && name.back() == '"')
      name = name.substr(1, name.size() - 2);
    names.emplace_back(name);
  }
  return has_pose_columns(names);
}

bool is_tum(const FileStart& start) { return has_numbers(start.first_line, 8); }

bool is_kitti(const FileStart& start) { return has_numbers(start.first_line, 12); }

}  // namespace vpr
