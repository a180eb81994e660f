#include "ground_truth/poses.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "base/utf8.h"
#include "ground_truth/builder.h"
#include "ground_truth/numbers.h"
#include "ground_truth/pose_csv.h"
#include "ground_truth/pose_matches.h"

namespace vpr {
namespace {

/// How far products of a matrix's rows may be from those of a rotation: files with three digits
/// have 0.002.
constexpr double kRotationError = 0.01;

double read_real(const FileLocation& location, std::string_view text) {
  const auto value = parse_real(text);
  if (!value) location.fail(fmt::format("\"{}\" is not a number", text));
  return *value;
}

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

Pose tum_pose(const FileLocation& location, const std::vector<double>& v) {
  const double norm = std::sqrt(v[4] * v[4] + v[5] * v[5] + v[6] * v[6] + v[7] * v[7]);
  if (!(norm > 1e-6) || !std::isfinite(norm)) location.fail("its quaternion is no rotation");
  const double x = v[4] / norm;
  const double y = v[5] / norm;
  const double z = v[6] / norm;
  const double w = v[7] / norm;
  Pose pose;
  pose.position = {v[1], v[2], v[3]};
  pose.orientation = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                      2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                      2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
  return pose;
}

// Whether the rows are at right angles, of length 1 and right-handed, but for rounding.
bool is_rotation(const std::array<double, 9>& m) {
  const auto dot = [&](size_t a, size_t b) {
    return m[3 * a] * m[3 * b] + m[3 * a + 1] * m[3 * b + 1] + m[3 * a + 2] * m[3 * b + 2];
  };
  for (size_t a = 0; a < 3; ++a)
    for (size_t b = a; b < 3; ++b)
      if (!(std::abs(dot(a, b) - (a == b ? 1 : 0)) <= kRotationError)) return false;
  return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
             m[2] * (m[3] * m[7] - m[4] * m[6]) >
         0;
}

Pose kitti_pose(const FileLocation& location, const std::vector<double>& v) {
  Pose pose;
  pose.position = {v[3], v[7], v[11]};
  pose.orientation = {v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10]};
  if (!is_rotation(*pose.orientation)) location.fail("its matrix is no rotation");
  return pose;
}

// One pose a line, of `columns` numbers.
Poses read_lines(const std::filesystem::path& path, size_t columns,
                 Pose (*make)(const FileLocation&, const std::vector<double>&)) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  const MappedFile file(source.path);
  FileLocation location{path.string()};
  Poses poses;
  size_t index = 0;
  size_t line_number = 0;
  for (const std::string_view line : split_lines(without_byte_order_mark(file.text()))) {
    ++line_number;
    const auto words = split_words(line);
    if (words.empty() || words.front().starts_with('#')) continue;
    location.at("line", line_number);
    if (words.size() != columns)
      location.fail(fmt::format("expected {} numbers, found {}", columns, words.size()));
    std::vector<double> values;
    for (const std::string_view word : words) values.push_back(read_real(location, word));
    if (frame_in_range(source.range, index++)) poses.emplace_back(make(location, values));
  }
  return poses;
}

Poses read_tum_lines(const std::filesystem::path& path, const FrameCount&) {
  return read_lines(path, 8, tum_pose);
}

Poses read_kitti_lines(const std::filesystem::path& path, const FrameCount&) {
  return read_lines(path, 12, kitti_pose);
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
