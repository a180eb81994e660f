#include "ground_truth/poses.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "ground_truth/builder.h"
#include "ground_truth/numbers.h"
#include "ground_truth/pose_csv.h"
#include "ground_truth/pose_matches.h"
#include "ground_truth/trajectory.h"

namespace vpr {
namespace {

/// Takes the poses of one file, whose name may end in a range.
using PoseReader = Poses (*)(const std::filesystem::path& path, const FrameCount& frames);

Poses read_csv_poses(const std::filesystem::path& path, const FrameCount& frames) {
  PoseCsvRules rules{frames.frames, kMostGrownFrames};
  if (frames.grows) rules.frames.reset();
  Poses poses;
  for (const auto& found : read_pose_csv(path, rules)) {
    poses.emplace_back();
    if (!found) continue;
    Pose& pose = poses.back().emplace();
    pose.position = {found->x, found->y, 0};
    pose.heading_deg = found->heading_deg;
  }
  return poses;
}

Poses read_tum_lines(const std::filesystem::path& path, const FrameCount&) {
  return read_tum_without_times(path);
}

Poses read_kitti_lines(const std::filesystem::path& path, const FrameCount&) {
  return read_kitti(path).poses;
}

Poses read_side(GroundTruthBuilder& builder, const std::filesystem::path& path,
                const FrameCount& frames, PoseReader read) {
  builder.at_file(path);  // for what is found out about the whole file
  return read(path, frames);
}

std::string read_both(GroundTruthBuilder& builder, std::string_view format, PoseReader read) {
  const GroundTruthArgument& argument = builder.argument();
  const size_t sequence = builder.only_searched(argument.path.string());
  if (argument.options.reference.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: has the poses of the query; give those of the training sequence, "
                            "as in --ground-truth-reference POSES",
                            argument.path.string()));
  const Poses query = read_side(builder, argument.path, builder.query(), read);
  builder.require_query_frames(query.size());
  const Poses train = read_side(builder, argument.options.reference, builder.train(sequence), read);
  builder.require_train_frames(sequence, train.size());
  return fmt::format("{} poses: {}", format, match_poses(builder, sequence, query, train));
}

bool has_numbers(std::string_view line, size_t count) {
  const auto words = split_words(line);
  return words.size() == count && std::all_of(words.begin(), words.end(), [](std::string_view w) {
           return parse_real(w).has_value();
         });
}

}  // namespace

std::string read_poses(GroundTruthBuilder& builder) {
  return read_both(builder, "csv", read_csv_poses);
}

std::string read_tum_poses(GroundTruthBuilder& builder) {
  return read_both(builder, "tum", read_tum_lines);
}

std::string read_kitti_poses(GroundTruthBuilder& builder) {
  return read_both(builder, "kitti", read_kitti_lines);
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
