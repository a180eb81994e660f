#include "ground_truth/travelled.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/monitor.h"
#include "ground_truth/pose_csv.h"

namespace vpr {

namespace {

using CsvPoses = std::vector<std::optional<CsvPose>>;

CsvPoses read_poses(const std::filesystem::path& path, size_t frames,
                    const std::optional<Replay>& replay) {
  if (!replay) return read_pose_csv(path, {frames});
  return replayed(read_pose_csv(path, {replay->recorded_frames}), *replay);
}

}  // namespace

std::vector<double> read_travelled(const std::filesystem::path& path, size_t frames,
                                   const Monitor& monitor, const std::optional<Replay>& replay) {
  const CsvPoses poses = read_poses(path, frames, replay);
  const auto known = [](const auto& pose) { return pose.has_value(); };
  const auto missing = std::find_if_not(poses.begin(), poses.end(), known);
  if (missing != poses.end()) {
    warn(monitor,
         fmt::format("{}: has no pose of {} of {} (the first is frame {}), so "
                     "nothing is given in metres",
                     path.string(),
                     frames - static_cast<size_t>(std::count_if(poses.begin(), poses.end(), known)),
                     counted(frames, "frame"), missing - poses.begin()));
    return {};
  }
  std::vector<double> travelled_m;
  for (size_t frame = 0; frame < frames; ++frame) {
    if (frame == 0) {
      travelled_m.push_back(0);
      continue;
    }
    double square = 0;
    for (size_t k = 0; k < 3; ++k) {
      const double step = poses[frame]->position[k] - poses[frame - 1]->position[k];
      square += step * step;
    }
    // Rounded correctly everywhere, which hypot is not.
    travelled_m.push_back(travelled_m.back() + std::sqrt(square));
  }
  if (!travelled_m.empty() && !std::isfinite(travelled_m.back()))
    throw Error(ErrorKind::data,
                fmt::format("{}: its positions are too far apart for metres", path.string()));
  return travelled_m;
}

}  // namespace vpr
