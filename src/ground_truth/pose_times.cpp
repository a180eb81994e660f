#include "ground_truth/pose_times.h"

#include <cmath>

#include <fmt/format.h>

#include "base/counted.h"
#include "base/error.h"
#include "ground_truth/association.h"
#include "ground_truth/frame_times.h"
#include "ground_truth/times.h"

namespace vpr {
namespace {

constexpr double kMostSeconds = 4e9;

/// What the options say of one side.
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
  if (!(std::abs(seconds) <= kMostSeconds))
    throw Error(ErrorKind::usage,
                fmt::format("{} must be at most {:g} seconds either way, found {:g}", flag,
                            kMostSeconds, seconds));
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
      throw Error(ErrorKind::usage,
                  fmt::format("{}: has times of its own; leave out --{}-pose-times",
                              trajectory.name, side.prefix));
    add_times(trajectory, side.poses);
  }
  if (trajectory.times_ns.empty() && !trajectory.poses.empty())
    throw Error(ErrorKind::usage, fmt::format("{}: has no times; give those of its poses with "
                                              "--{}-pose-times",
                                              trajectory.name, side.prefix));
  require_rising_times(trajectory);
}

// Poses without a position, of which GPS has some; the others keep their times.
void leave_out_unknown(Trajectory& trajectory) {
  size_t kept = 0;
  for (size_t i = 0; i < trajectory.poses.size(); ++i) {
    if (!trajectory.poses[i]) continue;
    trajectory.poses[kept] = trajectory.poses[i];
    trajectory.times_ns[kept] = trajectory.times_ns[i];
    ++kept;
  }
  trajectory.poses.resize(kept);
  trajectory.times_ns.resize(kept);
  trajectory.lines.clear();  // of poses that are no more
}

}  // namespace

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
      throw Error(ErrorKind::usage,
                  fmt::format("{}: pose i is that of frame i, unless --{}-times says when frames "
                              "were taken; then poses have times",
                              trajectory.name, times.prefix));
    return std::move(trajectory.poses);
  }
  add_pose_times(trajectory, times);
  leave_out_unknown(trajectory);
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
