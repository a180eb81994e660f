#include "truth/association.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "truth/times.h"

namespace vpr {
namespace {

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

// The lower of the two middle values for an even count; `values` is not empty.
int64_t median(std::vector<int64_t> values) {
  const auto middle = values.begin() + static_cast<ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The median absolute difference between a frame and its nearest pose.
int64_t median_difference(const Trajectory& trajectory, std::span<const int64_t> frame_times,
                          int64_t offset_ns) {
  std::vector<int64_t> differences;
  for (const int64_t frame_time : frame_times) {
    const int64_t time = frame_time + offset_ns;
    differences.push_back(
        std::abs(trajectory.times_ns[nearest_time(trajectory.times_ns, time)] - time));
  }
  return median(std::move(differences));
}

/// Advice about missing poses. A frame between two poses is at most half their distance from one of
/// them.
std::string remedy(const Trajectory& trajectory, const AssociationRules& rules,
                   int64_t difference) {
  std::vector<int64_t> gaps;
  for (size_t i = 1; i < trajectory.times_ns.size(); ++i)
    gaps.push_back(trajectory.times_ns[i] - trajectory.times_ns[i - 1]);
  const int64_t gap = gaps.empty() ? 0 : median(std::move(gaps));
  const int64_t half = (gap + 1) / 2;
  if (half <= rules.max_difference_ns || half < difference)
    return "If the clocks differ, use --offset";
  return fmt::format("Poses are {} s apart: --max-difference {}?", time_text(gap), time_text(half));
}

std::string range_of(std::span<const int64_t> times, int64_t offset_ns) {
  return fmt::format("{} to {} s", time_text(times.front() + offset_ns),
                     time_text(times.back() + offset_ns));
}

void report_missing(const Trajectory& trajectory, std::span<const int64_t> frame_times,
                    const AssociationRules& rules, const std::string& frames, size_t missing,
                    const Monitor& monitor) {
  const std::string ranges =
      fmt::format("they cover {}, but {} covers {}", range_of(frame_times, rules.offset_ns),
                  trajectory.name, range_of(trajectory.times_ns, 0));
  const int64_t difference = median_difference(trajectory, frame_times, rules.offset_ns);
  if (missing == frame_times.size())
    throw Error(
        ErrorKind::data,
        fmt::format("{}: no frame has a pose within {} s (--max-difference): {}; the median "
                    "difference to the nearest pose is {} s. {}",
                    frames, time_text(rules.max_difference_ns), ranges, time_text(difference),
                    remedy(trajectory, rules, difference)));
  warn(monitor, fmt::format("{}: {} of {} have no pose within {} s and are ignored: {}; the median "
                            "difference to the nearest pose is {} s. {}",
                            frames, missing, counted(frame_times.size(), "frame"),
                            time_text(rules.max_difference_ns), ranges, time_text(difference),
                            remedy(trajectory, rules, difference)));
}

constexpr double kMaxSeconds = 4e9;

/// The options of one side.
struct SideTimes {
  const char* prefix = "";
  const char* offset_flag = "";
  std::filesystem::path frames;
  std::filesystem::path poses;
  std::optional<double> offset_s;
};

SideTimes times_of(const GroundTruthOptions& options, PoseSide side) {
  if (side == PoseSide::query)
    return {"query", "--offset", options.query_times, options.query_pose_times, options.offset_s};
  return {"reference", "--reference-offset", options.reference_times, options.reference_pose_times,
          options.reference_offset_s};
}

int64_t nanoseconds(double seconds, const char* flag) {
  if (!(std::abs(seconds) <= kMaxSeconds))
    throw Error(ErrorKind::usage,
                fmt::format("{} must be at most {:g} seconds either way, found {:g}", flag,
                            kMaxSeconds, seconds));
  return std::llround(seconds * double{kSecond});
}

AssociationRules rules_of(const GroundTruthOptions& options, const SideTimes& side,
                          double usual_difference_s) {
  AssociationRules rules;
  rules.max_difference_ns =
      nanoseconds(options.max_difference_s.value_or(usual_difference_s), "--max-difference");
  if (rules.max_difference_ns < 0)
    throw Error(ErrorKind::usage, "--max-difference must not be negative");
  rules.offset_ns = nanoseconds(side.offset_s.value_or(0), side.offset_flag);
  return rules;
}

void add_pose_times(Trajectory& trajectory, const SideTimes& side) {
  if (!side.poses.empty()) {
    if (!trajectory.times_ns.empty())
      throw Error(ErrorKind::usage, fmt::format("{}: has its own times; remove --{}-pose-times",
                                                trajectory.name, side.prefix));
    add_times(trajectory, side.poses);
  }
  if (trajectory.times_ns.empty() && !trajectory.poses.empty())
    throw Error(ErrorKind::usage, fmt::format("{}: has no times; pass those of its poses with "
                                              "--{}-pose-times",
                                              trajectory.name, side.prefix));
  require_rising_times(trajectory);
}

// Removes poses without a position, which GPS files may have, together with their times.
void remove_unknown(Trajectory& trajectory) {
  size_t kept = 0;
  for (size_t i = 0; i < trajectory.poses.size(); ++i) {
    if (!trajectory.poses[i]) continue;
    trajectory.poses[kept] = trajectory.poses[i];
    trajectory.times_ns[kept] = trajectory.times_ns[i];
    ++kept;
  }
  trajectory.poses.resize(kept);
  trajectory.times_ns.resize(kept);
  trajectory.lines.clear();  // lines of removed poses are no longer valid
}

}  // namespace

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
  if (trajectory.poses.empty())
    throw Error(ErrorKind::data, fmt::format("{}: has no poses", trajectory.name));
  Poses poses = poses_at(trajectory, frame_times, rules);
  const auto missing = static_cast<size_t>(
      std::count_if(poses.begin(), poses.end(), [](const auto& pose) { return !pose; }));
  if (missing * 2 > poses.size())
    report_missing(trajectory, frame_times, rules, frames, missing, monitor);
  return poses;
}

std::string times_in_words(const GroundTruthOptions& options, double usual_difference_s) {
  if (options.query_times.empty() && options.reference_times.empty()) return "";
  const AssociationRules rules =
      rules_of(options, times_of(options, PoseSide::query), usual_difference_s);
  std::string words = fmt::format(" at the times of {}frames, the nearest within {} s",
                                  options.reference_times.empty() ? "query "
                                  : options.query_times.empty()   ? "training "
                                                                  : "",
                                  time_text(rules.max_difference_ns));
  for (const PoseSide side : {PoseSide::query, PoseSide::train})
    if (const SideTimes times = times_of(options, side); times.offset_s)
      words += fmt::format(", {} times {:+} s", times.prefix, *times.offset_s);
  return words;
}

Poses poses_of_side(const GroundTruthOptions& options, PoseSide side, Trajectory trajectory,
                    const Monitor& monitor, double usual_difference_s) {
  const SideTimes times = times_of(options, side);
  if (times.frames.empty()) {
    if (!times.poses.empty() || times.offset_s)
      throw Error(
          ErrorKind::usage,
          fmt::format("{}: pose i belongs to frame i, unless --{}-times has the times of frames; "
                      "then poses need times as well",
                      trajectory.name, times.prefix));
    return std::move(trajectory.poses);
  }
  add_pose_times(trajectory, times);
  remove_unknown(trajectory);
  return associate(trajectory, read_frame_times(times.frames, monitor),
                   rules_of(options, times, usual_difference_s), times.frames.string(), monitor);
}

TrainPoses read_train_poses(const std::filesystem::path& path, const GroundTruthOptions& options,
                            const Monitor& monitor) {
  Trajectory trajectory = read_any_trajectory(path);
  const bool is_on_earth = trajectory.is_on_earth;
  return {poses_of_side(options, PoseSide::train, std::move(trajectory), monitor), is_on_earth};
}

}  // namespace vpr
