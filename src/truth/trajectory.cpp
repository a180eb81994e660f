#include "truth/trajectory.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/converters.h"
#include "base/error.h"
#include "base/named_table.h"
#include "base/rows.h"
#include "base/text.h"
#include "truth/formats.h"
#include "truth/frame_cells.h"
#include "truth/frame_times.h"
#include "truth/layouts.h"
#include "truth/positions.h"
#include "truth/times.h"

namespace vpr {
namespace {

/// In meters.
constexpr double kLongestStep = 1000;
constexpr double kMaxSeconds = 2e9;  // 63 years
/// evo's maximum distance between a frame and its nearest pose, in seconds.
constexpr double kEvoDifference = 0.02;
/// The same for GPS. Receivers report one fix per second, so a frame is at most half a second from
/// the nearest fix, or one second if a fix is missing.
constexpr double kFixDifference = 1;

// Reads any format, with fixes as positions on the earth.
Trajectory read_any(const std::filesystem::path& path) {
  const FileStart start = open_start(path);
  if (is_pose_table(start.header)) return read_pose_csv(path, {}, /*with_times=*/true);
  if (start.is_folder || is_gps_header(start.header)) return read_fixes(path);
  if (start.layout != nullptr) return read_layout(path, *start.layout, true);
  refuse_convertible(start.path, start.bytes);
  if (const std::string hint = columns_hint(start); !hint.empty())
    throw Error(ErrorKind::usage, "{}{}", path.string(), hint);
  throw Error(
      ErrorKind::usage,
      "{}: is not a trajectory. Use one pose per line in a layout ({}), a CSV frame,x,y, or a "
      "CSV with lat and lon",
      path.string(), fmt::join(names_of(layouts()), ", "));
}

// Reads the times of the poses from a file; `remedy` is for a trajectory that has times.
void add_times(Trajectory& trajectory, const std::filesystem::path& times,
               const std::string& remedy) {
  if (!trajectory.times_ns.empty())
    throw Error(ErrorKind::usage, "{}: has its own times; remove {}", trajectory.name, remedy);
  trajectory.times_ns = read_time_list(times);
  if (trajectory.times_ns.size() != trajectory.poses.size())
    throw Error(ErrorKind::data, "{}: has {}, but {} has {}", times.string(),
                counted(trajectory.times_ns.size(), "time"), trajectory.name,
                counted(trajectory.poses.size(), "pose"));
}

Pose between(const Trajectory& trajectory, size_t before, size_t after, int64_t time) {
  const Pose& a = *trajectory.poses[before];
  const Pose& b = *trajectory.poses[after];
  const int64_t since = time - trajectory.times_ns[before];
  const int64_t until = trajectory.times_ns[after] - time;
  Pose pose = since <= until ? a : b;
  const double share = static_cast<double>(since) / static_cast<double>(since + until);
  for (size_t k = 0; k < 3; ++k)
    pose.position[k] = a.position[k] + share * (b.position[k] - a.position[k]);
  return pose;
}

// The lower of the two middle values for an even count; 0 for no values.
int64_t median(std::vector<int64_t> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The extent of missing poses, its likely cause, and advice.
std::string describe_missing(const Trajectory& trajectory, std::span<const int64_t> frame_times,
                             const AssociationRules& rules) {
  const std::vector<int64_t>& times = trajectory.times_ns;
  std::vector<int64_t> differences;
  for (const int64_t frame_time : frame_times) {
    const int64_t time = frame_time + rules.offset_ns;
    differences.push_back(std::abs(times[nearest_time(times, time)] - time));
  }
  const int64_t difference = median(std::move(differences));
  std::vector<int64_t> gaps;
  for (size_t i = 1; i < times.size(); ++i) gaps.push_back(times[i] - times[i - 1]);
  // A frame between two poses is at most half their distance from one of them.
  const int64_t gap = median(std::move(gaps));
  const int64_t half = (gap + 1) / 2;
  const bool is_dense = half <= rules.max_difference_ns || half < difference;
  return fmt::format(
      "they cover {} to {} s, but {} covers {} to {} s; the median difference to the nearest pose "
      "is {} s. {}",
      time_text(frame_times.front() + rules.offset_ns),
      time_text(frame_times.back() + rules.offset_ns), trajectory.name, time_text(times.front()),
      time_text(times.back()), time_text(difference),
      is_dense ? "If the clocks differ, use --offset"
               : fmt::format("Poses are {} s apart: --max-difference {}?", time_text(gap),
                             time_text(half)));
}

int64_t nanoseconds(double seconds, const char* flag) {
  if (!(std::abs(seconds) <= kMaxSeconds))
    throw Error(ErrorKind::usage, "{} must be from -{:g} to {:g} seconds, found {:g}", flag,
                kMaxSeconds, kMaxSeconds, seconds);
  return std::llround(seconds * double{kSecond});
}

AssociationRules rules_of(const GroundTruthArgument& argument, const SideOptions& side,
                          bool are_fixes) {
  const double default_s = are_fixes ? kFixDifference : kEvoDifference;
  AssociationRules rules;
  rules.max_difference_ns =
      nanoseconds(argument.options.max_difference_s.value_or(default_s), "--max-difference");
  if (rules.max_difference_ns < 0)
    throw Error(ErrorKind::usage, "--max-difference must not be negative");
  rules.offset_ns = nanoseconds(side.files.offset_s.value_or(0), side.offset_flag);
  return rules;
}

// Removes poses without a position, which GPS files may have, together with their times.
void remove_unknown(Trajectory& trajectory) {
  std::vector<int64_t> times;
  for (size_t i = 0; i < trajectory.poses.size(); ++i)
    if (trajectory.poses[i]) times.push_back(trajectory.times_ns[i]);
  trajectory.times_ns = std::move(times);
  std::erase_if(trajectory.poses, [](const auto& pose) { return !pose; });
  trajectory.lines.clear();  // lines of removed poses are no longer valid
}

// A column of cells that may be names; empty: missing.
using NameColumn = std::vector<std::string>;

bool has_numbers(const NameColumn& column) {
  return std::ranges::any_of(column, [](const std::string& cell) {
    return parse_real(cell) && no_number_hint(cell).empty();
  });
}

// Whether numbers increase, as counters and times do, so that they are in the order of the frames.
bool is_increasing(const NameColumn& column) {
  std::optional<double> last;
  return std::ranges::all_of(column, [&](const std::string& cell) {
    if (cell.empty()) return true;
    const auto value = parse_real(cell);
    const bool is_later = value && (!last || *value > *last);
    last = value;
    return is_later;
  });
}

bool are_different(const NameColumn& column) {
  std::set<std::string_view> seen;
  return std::ranges::all_of(
      column, [&](const std::string& cell) { return cell.empty() || seen.insert(cell).second; });
}

// The number of frames that cells name; 0 unless more than half of the cells do or, for numbers,
// each names another frame and they are in another order.
size_t count_names(const FrameNames& frames, const NameColumn& column) {
  std::set<size_t> named;
  for (const std::string& cell : column)
    if (const auto frame = cell.empty() ? std::nullopt : frames.find(cell)) named.insert(*frame);
  const bool are_names = has_numbers(column)
                             ? named.size() == column.size() && !is_increasing(column)
                             : 2 * named.size() > column.size();
  return are_names ? named.size() : 0;
}

// The poses of the frames that the lines name.
Poses poses_by_name(const Trajectory& trajectory, const SideOptions& side,
                    const NameReader& reader) {
  const std::optional<FrameNames> names = find_names(reader);
  if (!names)
    throw Error(ErrorKind::usage,
                "{}: names its frames, such as {}. Pass their images with --{}-images FOLDER",
                trajectory.name, trajectory.names.front(), side.name);
  if (!parse_sequence_argument(trajectory.name).range.is_all())
    throw Error(ErrorKind::usage,
                "{}: its lines are selected by names. Add the range to the images",
                trajectory.name);
  const bool must_have_all = !side.files.images.empty();
  const auto count = static_cast<size_t>(std::ranges::count_if(
      trajectory.names, [&](const std::string& name) { return names->find(name).has_value(); }));
  if (count == 0 && !must_have_all)
    throw Error(ErrorKind::data, "{}: no line names a frame of the sequence; the first names {}",
                trajectory.name, trajectory.names.front());
  for (size_t i = 0; must_have_all && i < trajectory.names.size(); ++i)
    if (const std::string& name = trajectory.names[i]; !name.empty() && !names->find(name))
      FileLocation{trajectory.name, "line", trajectory.lines[i]}.fail(
          "{} has no image {}, or several", side.files.images.string(), name);
  const auto entries =
      entries_by_frame(*names, trajectory.names, trajectory.lines, trajectory.name);
  const auto is_number = [](const std::string& name) { return parse_frame(name).has_value(); };
  if (count > 0 &&
      !std::ranges::all_of(entries, [](const auto& entry) { return entry.has_value(); }) &&
      std::ranges::all_of(trajectory.names, is_number) && !names->find("0") &&
      std::ranges::find(trajectory.names, "0") != trajectory.names.end())
    throw Error(ErrorKind::data,
                "{}: its numbers of frames count from 0, which does not name a frame, so it is "
                "unclear which frames {} and others are. Call the column \"frame\", or write names "
                "with their extension",
                trajectory.name, names->name(0));
  Poses poses;
  for (const auto entry : entries) poses.push_back(entry ? trajectory.poses[*entry] : std::nullopt);
  return poses;
}

}  // namespace

void choose_names(Trajectory& trajectory, const NameReader& reader, const Monitor& monitor) {
  const auto columns = std::exchange(trajectory.name_columns, {});
  if (columns.empty() || trajectory.poses.size() < 2) return;
  const auto may_be_names = [](const NameColumn& column) {
    return are_different(column) && !(has_numbers(column) && is_increasing(column));
  };
  std::optional<FrameNames> frames;
  try {
    frames = find_names(reader);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input || std::ranges::any_of(columns, may_be_names)) throw;
  }
  size_t most = 0;
  for (const NameColumn& column : columns) {
    const size_t count = frames ? count_names(*frames, column) : 0;
    if (count <= most) continue;
    most = count;
    trajectory.names = column;
  }
  if (most > 0 && has_numbers(trajectory.names))
    warn(monitor,
         "{}: {} is read as the name of frame {}, because every cell of its column is a name. If "
         "line i belongs to frame i, remove the column",
         trajectory.name, trajectory.names.front(), *frames->find(trajectory.names.front()));
  const auto are_images = [](const NameColumn& column) {
    return are_different(column) &&
           2 * std::ranges::count_if(column, is_frame_name) > std::ssize(column);
  };
  const auto images = std::ranges::find_if(columns, are_images);
  if (most == 0 && images != columns.end()) trajectory.names = *images;
}

size_t count_unknown(const Poses& poses) {
  return static_cast<size_t>(std::ranges::count_if(poses, [](const auto& pose) { return !pose; }));
}

std::array<double, 3> extents_of(const Poses& poses) {
  std::array<double, 3> extents{};
  for (size_t axis = 0; axis < 3; ++axis) {
    double least = std::numeric_limits<double>::infinity();
    double greatest = -least;
    for (const auto& pose : poses) {
      if (!pose) continue;
      least = std::min(least, pose->position[axis]);
      greatest = std::max(greatest, pose->position[axis]);
    }
    extents[axis] = greatest - least;
  }
  return extents;
}

std::optional<double> angle_between(const Pose& a, const Pose& b) {
  if (a.heading_deg && b.heading_deg)
    return std::abs(std::remainder(*a.heading_deg - *b.heading_deg, 360.0));
  if (!a.orientation || !b.orientation) return std::nullopt;
  const double trace =
      std::inner_product(a.orientation->begin(), a.orientation->end(), b.orientation->begin(), 0.0);
  return std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0)) * 180 / std::numbers::pi;
}

void refuse_angle(const std::string& file, size_t frame) {
  throw Error(
      ErrorKind::data,
      "{}: frame {} has no heading, which --angle needs. Its column is \"heading\", in degrees",
      file, frame);
}

void warn_of_headings(const std::string& file, const Poses& poses, const Monitor& monitor) {
  const Pose* first = nullptr;
  size_t count = 0;
  bool are_equal = true;
  bool are_radians = true;
  for (const auto& pose : poses) {
    if (!pose || !has_heading(*pose)) continue;
    if (first == nullptr) first = &*pose;
    ++count;
    are_equal = are_equal && pose->heading_deg == first->heading_deg &&
                pose->orientation == first->orientation;
    are_radians =
        are_radians && pose->heading_deg && std::abs(*pose->heading_deg) <= 2 * std::numbers::pi;
  }
  if (count < 2 || !(are_equal || are_radians)) return;
  warn(monitor, "{}: all {} headings are {}, so --angle {}", file, count,
       are_equal ? "equal" : "between -6.28 and 6.28 degrees",
       are_equal ? "has no effect on this side. Are they unknown?"
                 : "can hardly have an effect. Are they radians? Convert them to degrees");
}

void check_nearness(const Nearness& nearness) {
  const auto is_limit = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!is_limit(nearness.radius_m) || !is_limit(nearness.angle_deg.value_or(0)) ||
      !is_limit(nearness.ignore_radius_m.value_or(0)))
    throw Error(ErrorKind::usage,
                "radius and angle of the same place must be finite and at least 0");
  if (nearness.ignore_radius_m && *nearness.ignore_radius_m < nearness.radius_m)
    throw Error(ErrorKind::usage,
                "--ignore-radius {} is less than the radius, {}: pairs between the two are ignored",
                *nearness.ignore_radius_m, nearness.radius_m);
}

double square_distance(const Pose& a, const Pose& b) {
  if (!a.area.empty() && !b.area.empty() && a.area != b.area)
    return std::numeric_limits<double>::infinity();
  double square = 0;
  for (size_t k = 0; k < 3; ++k) {
    const double difference = b.position[k] - a.position[k];
    square += difference * difference;
  }
  return square;
}

std::optional<PlaceLabel> label_of(const Pose& a, const Pose& b, const Nearness& nearness) {
  const double square = square_distance(a, b);
  const auto is_within = [&](double radius_m) { return square <= radius_m * radius_m; };
  if (!is_within(nearness.farthest_m())) return PlaceLabel::different;
  if (nearness.angle_deg) {
    const auto angle = angle_between(a, b);
    if (!angle) return std::nullopt;
    if (*angle > *nearness.angle_deg) return PlaceLabel::different;
  }
  return is_within(nearness.radius_m) ? PlaceLabel::same : PlaceLabel::ignore;
}

void warn_of_steps(const Trajectory& trajectory, const Monitor& monitor) {
  const Poses& poses = trajectory.poses;
  size_t count = 0;
  size_t first = 0;
  for (size_t i = 1; i < poses.size(); ++i) {
    if (!poses[i - 1] || !poses[i] || poses[i - 1]->area != poses[i]->area ||
        square_distance(*poses[i - 1], *poses[i]) <= kLongestStep * kLongestStep)
      continue;
    if (count++ == 0) first = i;
  }
  if (count == 0) return;
  warn(monitor,
       "{}: {} longer than {:g} m, such as {:.0f} m from pose {} to pose {}. Positions must be in "
       "meters, and unknown ones nan",
       trajectory.name, counted(count, "step between poses is", "steps between poses are"),
       kLongestStep, std::sqrt(square_distance(*poses[first - 1], *poses[first])), first - 1,
       first);
}

void require_rising_times(const Trajectory& trajectory) {
  FileLocation location{trajectory.name};
  for (size_t i = 1; i < trajectory.times_ns.size(); ++i) {
    if (trajectory.times_ns[i] > trajectory.times_ns[i - 1]) continue;
    if (i < trajectory.lines.size()) location.at("line", trajectory.lines[i]);
    refuse_time_order(location, trajectory.times_ns[i - 1], trajectory.times_ns[i]);
  }
}

Trajectory read_trajectory(const std::filesystem::path& path, const std::filesystem::path& times) {
  Trajectory found = read_any(path);
  std::optional<LocalPlane> plane;
  flatten(found, plane);
  const bool has_own_times = !found.times_ns.empty();
  if (!times.empty()) add_times(found, times, times.string());
  choose_names(found, {}, {});
  if (!found.names.empty() && !has_own_times)
    throw Error(ErrorKind::usage,
                "{}: names its frames in any order. Write one pose per frame, in their order",
                path.string());
  return found;
}

Poses poses_at(const Trajectory& trajectory, std::span<const int64_t> frame_times,
               const AssociationRules& rules) {
  const auto& times = trajectory.times_ns;
  Poses poses;
  size_t after = 0;  // the first pose at or after the frame
  for (const int64_t frame_time : frame_times) {
    const int64_t time = frame_time + rules.offset_ns;
    while (after < times.size() && times[after] < time) ++after;
    const size_t before = after > 0 ? after - 1 : 0;
    const size_t last = std::min(after, times.size() - 1);
    const int64_t difference =
        std::min(std::abs(times[before] - time), std::abs(times[last] - time));
    poses.emplace_back();
    if (difference > rules.max_difference_ns) continue;
    poses.back() = before == last || times[last] == time ? *trajectory.poses[last]
                                                         : between(trajectory, before, last, time);
  }
  return poses;
}

Poses associate(const Trajectory& trajectory, std::span<const int64_t> frame_times,
                const AssociationRules& rules, const std::string& frames, const Monitor& monitor) {
  if (trajectory.poses.empty()) throw Error(ErrorKind::data, "{}: has no poses", trajectory.name);
  Poses poses = poses_at(trajectory, frame_times, rules);
  const size_t missing = count_unknown(poses);
  if (missing * 2 <= poses.size()) return poses;
  const std::string within = time_text(rules.max_difference_ns);
  const std::string cause = describe_missing(trajectory, frame_times, rules);
  if (missing == poses.size())
    throw Error(ErrorKind::data, "{}: no frame has a pose within {} s (--max-difference): {}",
                frames, within, cause);
  warn(monitor, "{}: {} of {} have no pose within {} s and are ignored: {}", frames, missing,
       counted(poses.size(), "frame"), within, cause);
  return poses;
}

SideOptions side_options(const GroundTruthArgument& argument, PoseSide side) {
  const GroundTruthOptions& options = argument.options;
  if (side == PoseSide::query) return {"query", "--offset", argument.path, options.query};
  return {"train", "--train-offset", options.reference, options.train};
}

std::string describe_times(const GroundTruthArgument& argument, bool are_fixes) {
  const TruthSide& query = argument.options.query;
  const TruthSide& train = argument.options.train;
  if (query.times.empty() && train.times.empty()) return "";
  const AssociationRules rules =
      rules_of(argument, side_options(argument, PoseSide::query), are_fixes);
  std::string words = fmt::format(" at the times of {}frames, the nearest within {} s",
                                  train.times.empty()   ? "query "
                                  : query.times.empty() ? "training "
                                                        : "",
                                  time_text(rules.max_difference_ns));
  if (query.offset_s) words += fmt::format(", query times {:+} s", *query.offset_s);
  if (train.offset_s) words += fmt::format(", training times {:+} s", *train.offset_s);
  return words;
}

NameReader names_of_side(const TruthSide& files, const NameReader& names) {
  if (files.images.empty()) return names;
  const SequenceArgument argument = parse_sequence_argument(files.images.string());
  if (open_sequence(argument).kind != SequenceKind::images)
    throw Error(ErrorKind::usage,
                "{}: is not a folder or list of images, to which a file of positions can refer "
                "by name",
                files.images.string());
  return name_reader(argument);
}

Poses poses_of_side(const GroundTruthArgument& argument, PoseSide pose_side, Trajectory trajectory,
                    const NameReader& names, const Monitor& monitor) {
  const SideOptions side = side_options(argument, pose_side);
  const TruthSide& files = side.files;
  const NameReader reader = names_of_side(files, names);
  if (files.times.empty()) {
    if (!trajectory.names.empty()) return poses_by_name(trajectory, side, reader);
    const GroundTruthOptions& options = argument.options;
    const bool has_times = !options.query.times.empty() || !options.train.times.empty();
    if (!files.pose_times.empty() || files.offset_s || (options.max_difference_s && !has_times))
      throw Error(ErrorKind::usage,
                  "{}: pose i belongs to frame i. To associate frames by time, also pass the times "
                  "of frames with --{}-times",
                  trajectory.name, side.name);
    return std::move(trajectory.poses);
  }
  if (!files.pose_times.empty())
    add_times(trajectory, files.pose_times, fmt::format("--{}-pose-times", side.name));
  if (trajectory.times_ns.empty() && !trajectory.poses.empty())
    throw Error(ErrorKind::usage,
                "{}: has no times. Pass the times of its poses with --{}-pose-times",
                trajectory.name, side.name);
  require_rising_times(trajectory);
  remove_unknown(trajectory);
  return associate(trajectory, read_frame_times(files.times, reader, monitor),
                   rules_of(argument, side, trajectory.is_on_earth), files.times.string(), monitor);
}

Trajectory read_train_poses(const std::filesystem::path& path, const GroundTruthOptions& options,
                            const NameReader& names, const Monitor& monitor) {
  Trajectory read = read_any(path);
  if (options.train.times.empty()) choose_names(read, names_of_side(options.train, names), monitor);
  Trajectory found{.name = read.name, .is_on_earth = read.is_on_earth};
  found.poses =
      poses_of_side({"", {}, 0, options}, PoseSide::train, std::move(read), names, monitor);
  return found;
}

}  // namespace vpr
