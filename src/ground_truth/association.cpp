#include "ground_truth/association.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "base/counted.h"
#include "base/error.h"
#include "ground_truth/times.h"

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

/// From each frame to its nearest pose, the middle one of them: what the clocks may differ by.
int64_t median_difference(const Trajectory& trajectory, std::span<const int64_t> frame_times,
                          int64_t offset_ns) {
  std::vector<int64_t> differences;
  for (const int64_t frame_time : frame_times) {
    const int64_t time = frame_time + offset_ns;
    differences.push_back(trajectory.times_ns[nearest_time(trajectory.times_ns, time)] - time);
  }
  const auto middle = differences.begin() + static_cast<ptrdiff_t>((differences.size() - 1) / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

std::string range_of(std::span<const int64_t> times, int64_t offset_ns) {
  return fmt::format("{} to {} s", time_text(times.front() + offset_ns),
                     time_text(times.back() + offset_ns));
}

void report_missing(const Trajectory& trajectory, std::span<const int64_t> frame_times,
                    const AssociationRules& rules, const std::string& frames, size_t missing,
                    const Monitor& monitor) {
  const std::string ranges =
      fmt::format("they are of {}, and {} is of {}", range_of(frame_times, rules.offset_ns),
                  trajectory.name, range_of(trajectory.times_ns, 0));
  const std::string median = time_text(median_difference(trajectory, frame_times, rules.offset_ns));
  if (missing == frame_times.size())
    throw Error(
        ErrorKind::data,
        fmt::format("{}: no frame has a pose within {} s (--max-difference): {}; the median "
                    "difference to the nearest pose is {} s; if clocks differ, say by how "
                    "much (--offset)",
                    frames, time_text(rules.max_difference_ns), ranges, median));
  warn(monitor,
       fmt::format("{}: {} of {} have no pose within {} s (--max-difference), and are not judged: "
                   "{}; the median difference to the nearest pose is {} s",
                   frames, missing, counted(frame_times.size(), "frame"),
                   time_text(rules.max_difference_ns), ranges, median));
}

}  // namespace

Poses poses_at(const Trajectory& trajectory, std::span<const int64_t> frame_times,
               const AssociationRules& rules) {
  const auto& times = trajectory.times_ns;
  Poses poses;
  size_t after = 0;  // the first pose that is not before the frame
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

}  // namespace vpr
