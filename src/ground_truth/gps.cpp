#include "ground_truth/gps.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/converters.h"
#include "base/counted.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "ground_truth/builder.h"
#include "ground_truth/geodesy.h"
#include "ground_truth/gps_columns.h"
#include "ground_truth/gps_csv.h"
#include "ground_truth/pose_times.h"
#include "ground_truth/poses.h"

namespace vpr {
namespace {

/// Seconds. Receivers have one fix a second, so that a frame is half a second from the nearest, or
/// a second where one was lost.
constexpr double kUsualDifference = 1;

std::vector<std::string> header_of(std::string_view line) {
  std::vector<std::string> names;
  for (std::string_view name : split(line, ',')) {
    while (name.ends_with('\r')) name.remove_suffix(1);
    if (name.size() >= 2 && name.front() == '"' && name.back() == '"')
      name = name.substr(1, name.size() - 2);
    names.emplace_back(name);
  }
  return names;
}

FileStart start_of(const std::filesystem::path& path, const MappedFile& file) {
  FileStart start;
  start.path = path;
  start.bytes = file.text();
  for (const std::string_view line : split_lines(start.bytes))
    if (!line.empty() && !line.starts_with('#')) {
      start.first_line = line;
      break;
    }
  return start;
}

void check_fixes(const GroundTruthBuilder& builder, const std::filesystem::path& path,
                 const Poses& poses) {
  const auto missing = static_cast<size_t>(
      std::count_if(poses.begin(), poses.end(), [](const auto& pose) { return !pose; }));
  if (missing == poses.size())
    throw Error(ErrorKind::data, fmt::format("{}: has no fix of any frame", path.string()));
  if (missing * 2 > poses.size())
    builder.warn_user(fmt::format("{}: {} of {} have no fix, and are not judged", path.string(),
                                  missing, counted(poses.size(), "frame")));
}

Poses read_side(const GroundTruthBuilder& builder, PoseSide side, const FrameCount& count) {
  const GroundTruthOptions& options = builder.argument().options;
  const bool is_query = side == PoseSide::query;
  const std::filesystem::path& path = is_query ? builder.argument().path : options.reference;
  const std::filesystem::path& images = is_query ? options.query_images : options.reference_images;
  std::optional<size_t> frames;
  if (!count.grows) frames = count.frames;
  Poses poses = poses_of_side(builder.argument().options, side, read_fixes(path, images, frames),
                              builder.monitor(), kUsualDifference);
  const bool is_by_time = !(is_query ? options.query_times : options.reference_times).empty();
  if (!is_by_time) check_fixes(builder, path, poses);  // by time it has been said
  return poses;
}

}  // namespace

bool is_gps(const FileStart& start) {
  return find_gps_columns(header_of(start.first_line)).has_value();
}

Trajectory read_fixes(const std::filesystem::path& path, const std::filesystem::path& images,
                      std::optional<size_t> frames) {
  const std::filesystem::path file_path = parse_sequence_argument(path.string()).path;
  std::error_code error;
  if (std::filesystem::is_directory(file_path, error))
    throw Error(ErrorKind::usage,
                fmt::format("{} is a folder: write the GPS positions of its images to a CSV with "
                            "scripts/convert/exif.py",
                            path.string()));
  const MappedFile file(file_path);
  const FileStart start = start_of(file_path, file);
  if (is_gps(start)) return read_gps_csv(path, images, frames);
  refuse_unconverted(file_path, start.bytes);
  throw Error(ErrorKind::data,
              fmt::format("{}: is not a CSV with latitudes and longitudes{}", path.string(),
                          is_pose_csv(start) ? "; its positions are in meters" : ""));
}

std::string read_gps(GroundTruthBuilder& builder) {
  const GroundTruthArgument& argument = builder.argument();
  const size_t sequence = builder.only_searched(argument.path.string());
  if (argument.options.reference.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: has the fixes of the query; give those of the training sequence, "
                            "as in --ground-truth-reference FIXES",
                            argument.path.string()));
  builder.at_file(argument.path);
  const Poses query = read_side(builder, PoseSide::query, builder.query());
  builder.require_query_frames(query.size());
  builder.at_file(argument.options.reference);
  const Poses train = read_side(builder, PoseSide::train, builder.train(sequence));
  builder.require_train_frames(sequence, train.size());
  return fmt::format("gps positions{}: {}", times_in_words(argument.options, kUsualDifference),
                     match_poses(builder, sequence, query, train));
}

void level(Trajectory& trajectory) {
  if (!trajectory.is_on_earth) return;
  std::optional<LocalPlane> plane;
  for (auto& pose : trajectory.poses) {
    if (!pose) continue;
    if (!plane) plane.emplace(pose->position);
    pose->position = plane->local(pose->position);
  }
  trajectory.is_on_earth = false;
}

}  // namespace vpr
