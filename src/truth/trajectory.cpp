#include "truth/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "base/converters.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "truth/gps.h"
#include "truth/poses.h"
#include "truth/route.h"
#include "truth/text_file.h"
#include "truth/times.h"

namespace vpr {
namespace {

/// Tolerance for the products of a matrix's rows: files with three digits have errors of 0.002.
constexpr double kRotationError = 0.01;

// A quaternion x, y, z, w as a matrix.
std::array<double, 9> rotation_of(const FileLocation& location, std::array<double, 4> q) {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(norm > 1e-6) || !std::isfinite(norm)) location.fail("its quaternion is not a rotation");
  const double x = q[0] / norm;
  const double y = q[1] / norm;
  const double z = q[2] / norm;
  const double w = q[3] / norm;
  return {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
          2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
          2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
}

Pose tum_pose(const FileLocation& location, std::span<const double> v) {
  return {{v[1], v[2], v[3]}, {}, rotation_of(location, {v[4], v[5], v[6], v[7]})};
}

Pose euroc_pose(const FileLocation& location, std::span<const double> v) {
  return {{v[1], v[2], v[3]}, {}, rotation_of(location, {v[5], v[6], v[7], v[4]})};
}

// Whether the rows are orthonormal and right-handed, up to rounding.
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

Pose kitti_pose(const FileLocation& location, std::span<const double> v) {
  Pose pose;
  pose.position = {v[3], v[7], v[11]};
  pose.orientation = {v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10]};
  if (!is_rotation(*pose.orientation)) location.fail("its matrix is not a rotation");
  return pose;
}

/// Limit for a CSV, which may name any frame.
constexpr size_t kMaxFrames = 1'000'000;

/// The layout of a pose in one kind of file.
struct LineLayout {
  size_t columns = 0;
  bool may_have_more = false;
  std::optional<TimeUnit> unit = {};  ///< of the first column; unset: determined by the file
  bool has_times = true;
  Pose (*pose)(const FileLocation& location, std::span<const double> values) = nullptr;
};

constexpr LineLayout kTum = {8, false, {}, true, tum_pose};
constexpr LineLayout kTumPoses = {8, false, {}, false, tum_pose};
constexpr LineLayout kEuroc = {8, true, TimeUnit::nanoseconds, true, euroc_pose};
constexpr LineLayout kKitti = {12, false, {}, false, kitti_pose};

std::vector<double> read_numbers(const FileLocation& location, const LineLayout& layout,
                                 std::span<const std::string_view> words) {
  if (words.size() < layout.columns || (!layout.may_have_more && words.size() > layout.columns))
    location.fail(fmt::format("expected {} numbers, found {}", layout.columns, words.size()));
  std::vector<double> values;
  for (const std::string_view word : words.first(layout.columns)) {
    const auto value = parse_real(word);
    if (!value) location.fail(fmt::format("\"{}\" is not a number", word));
    values.push_back(*value);
  }
  return values;
}

Trajectory read_lines(const std::filesystem::path& path, const LineLayout& layout) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  const MappedFile file(source.path);
  FileLocation location{path.string()};
  Trajectory found;
  found.name = path.string();
  std::optional<TimeUnit> unit = layout.unit;
  size_t index = 0;
  size_t line_number = 0;
  for (const std::string_view line : split_lines(without_byte_order_mark(file.text()))) {
    ++line_number;
    const auto words = cells_of(line);
    if (words.empty() || words.front().starts_with('#')) continue;
    location.at("line", line_number);
    const std::vector<double> values = read_numbers(location, layout, words);
    if (layout.has_times && !unit) unit = unit_of_time(words[0]);
    if (!frame_in_range(source.range, index++)) continue;
    found.poses.emplace_back(layout.pose(location, values));
    found.lines.push_back(line_number);
    if (layout.has_times) found.times_ns.push_back(read_time(location, words[0], *unit));
  }
  return found;
}

}  // namespace

Trajectory read_csv_trajectory(const std::filesystem::path& path, std::optional<size_t> frames) {
  Trajectory found;
  found.name = path.string();
  for (const auto& row : read_pose_csv(path, {frames, kMaxFrames})) {
    found.poses.push_back(row ? std::optional(row->pose) : std::nullopt);
    if (row) found.is_on_earth = row->is_on_earth;
  }
  return found;
}

Trajectory read_tum(const std::filesystem::path& path) { return read_lines(path, kTum); }

Trajectory read_tum_without_times(const std::filesystem::path& path) {
  return read_lines(path, kTumPoses);
}

Trajectory read_euroc(const std::filesystem::path& path) { return read_lines(path, kEuroc); }

Trajectory read_kitti(const std::filesystem::path& path) { return read_lines(path, kKitti); }

bool is_euroc(const FileStart& start) {
  const auto words = cells_of(start.first_line);
  return words.size() >= kEuroc.columns &&
         std::all_of(words.begin(), words.begin() + static_cast<ptrdiff_t>(kEuroc.columns),
                     [](std::string_view word) { return parse_real(word).has_value(); }) &&
         unit_of_time(words[0]) == TimeUnit::nanoseconds;
}

void require_rising_times(const Trajectory& trajectory) {
  FileLocation location{trajectory.name};
  for (size_t i = 1; i < trajectory.times_ns.size(); ++i) {
    if (trajectory.times_ns[i] > trajectory.times_ns[i - 1]) continue;
    if (i < trajectory.lines.size()) location.at("line", trajectory.lines[i]);
    refuse_time_order(location, trajectory.times_ns[i - 1], trajectory.times_ns[i]);
  }
}

void add_times(Trajectory& trajectory, const std::filesystem::path& times) {
  trajectory.times_ns = read_time_list(times);
  if (trajectory.times_ns.size() != trajectory.poses.size())
    throw Error(ErrorKind::data,
                fmt::format("{}: has {}, but {} has {}", times.string(),
                            counted(trajectory.times_ns.size(), "time"), trajectory.name,
                            counted(trajectory.poses.size(), "pose")));
}

Trajectory read_any_trajectory(const std::filesystem::path& path) {
  const StartedFile opened = open_start(path);
  const FileStart& start = opened.start;
  if (start.is_folder) return read_fixes(path);
  if (is_tum(start)) return read_tum(path);
  if (is_euroc(start)) return read_euroc(path);
  if (is_kitti(start)) return read_kitti(path);
  if (is_pose_csv(start)) return read_csv_trajectory(path);
  if (is_gps(start)) return read_fixes(path);
  refuse_unconverted(start.path, start.bytes);
  throw Error(ErrorKind::usage,
              fmt::format("{}: is not a trajectory; expected one pose per line in the format of "
                          "TUM (8 numbers), KITTI "
                          "(12 numbers) or EuRoC (time in ns and more, with commas), "
                          "a CSV frame,x,y, or a CSV with lat and lon",
                          path.string()));
}

Trajectory read_trajectory(const std::filesystem::path& path, const std::filesystem::path& times) {
  Trajectory found = read_any_trajectory(path);
  level(found);
  require_rising_times(found);
  if (times.empty()) return found;
  if (!found.times_ns.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: has its own times; remove {}", path.string(), times.string()));
  add_times(found, times);
  return found;
}

}  // namespace vpr
