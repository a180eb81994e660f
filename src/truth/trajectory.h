// Trajectories of SLAM systems and data sets as text: poses, and where a file has them, their
// times.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "truth/formats.h"
#include "truth/poses.h"

namespace vpr {

/// The poses of one file, by frame.
struct Trajectory {
  std::string name;               ///< of the file, for errors
  Poses poses;                    ///< nothing where the file has no pose of a frame
  std::vector<size_t> lines;      ///< of each pose in the file, counted from 1; none of a CSV
  std::vector<int64_t> times_ns;  ///< one a pose as the file has them, or none at all
  bool is_on_earth = false;       ///< positions are those of gps.h
};

/// One pose a line: time x y z qx qy qz qw (TUM). Times may fall or repeat. All readers of this
/// header take a range behind the path (PATH@FIRST:LAST[:STEP]), and throw Error(input) if a file
/// can't be read and Error(data), naming the line, if it is damaged.
Trajectory read_tum(const std::filesystem::path& path);
/// The same without a look at the times, but that they are numbers.
Trajectory read_tum_without_times(const std::filesystem::path& path);

/// One pose a line, commas between: time in nanoseconds, x y z, qw qx qy qz, and maybe more
/// (EuRoC's state_groundtruth_estimate0/data.csv); lines that start with # are skipped.
Trajectory read_euroc(const std::filesystem::path& path);
/// Whether the first line holds a whole number of nanoseconds and at least seven more numbers.
bool is_euroc(const FileStart& start);

/// One pose a line, the 3 x 4 matrix row by row (KITTI), without times. Matrices that are no
/// rotation are refused.
Trajectory read_kitti(const std::filesystem::path& path);

/// A CSV with columns frame, x and y, or latitude and longitude, as read_pose_csv() reads it,
/// without times. `frames`: how many the sequence has, if that is known.
Trajectory read_csv_trajectory(const std::filesystem::path& path,
                               std::optional<size_t> frames = std::nullopt);

/// Any of these by its content, or GPS fixes (gps.h) as positions on the earth. Throws Error(usage)
/// if the file is none of these.
Trajectory read_any_trajectory(const std::filesystem::path& path);

/// The same, with GPS fixes on a plane that touches the earth at the first. Of a file without
/// times, `times`, which may be empty, has them: one a line (KITTI's times.txt), as many as poses.
/// Times must rise. Throws Error(usage) if the file is none of these, or times are given twice.
Trajectory read_trajectory(const std::filesystem::path& path, const std::filesystem::path& times);

/// Takes the times of the poses from a file. Throws Error(data) if they are not as many.
void add_times(Trajectory& trajectory, const std::filesystem::path& times);

/// Throws Error(data), naming the line, where a time is not after the one before.
void require_rising_times(const Trajectory& trajectory);

}  // namespace vpr
