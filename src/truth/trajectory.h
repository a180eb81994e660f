// Trajectories of SLAM systems and data sets as text: poses, with times if the file has them.
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
  std::string name;           ///< of the file, for errors
  Poses poses;                ///< nullopt if the file has no pose for a frame
  std::vector<size_t> lines;  ///< line of each pose in the file, counted from 1; empty for a CSV
  std::vector<int64_t> times_ns;  ///< one per pose, or empty if the file has no times
  bool is_on_earth = false;       ///< positions are those of gps.h
};

/// One pose per line: time x y z qx qy qz qw (TUM). Times need not increase. All readers of this
/// header accept a range after the path (PATH@FIRST:LAST[:STEP]), and throw Error(input) if a file
/// cannot be read and Error(data), with the line, if it is damaged.
Trajectory read_tum(const std::filesystem::path& path);
/// As read_tum, but times may be any numbers and are ignored.
Trajectory read_tum_without_times(const std::filesystem::path& path);

/// One pose per line, separated by commas: time in nanoseconds, x y z, qw qx qy qz, and optionally
/// more (EuRoC's state_groundtruth_estimate0/data.csv); lines that start with # are skipped.
Trajectory read_euroc(const std::filesystem::path& path);
/// Whether the first line holds an integer number of nanoseconds and at least seven more numbers.
bool is_euroc(const FileStart& start);

/// One pose per line, the 3 x 4 matrix row by row (KITTI), without times. Refuses a matrix that is
/// not a rotation.
Trajectory read_kitti(const std::filesystem::path& path);

/// A CSV with columns frame, x and y, or latitude and longitude (read_pose_csv()), without times.
/// `frames`: the number of frames of the sequence, if known.
Trajectory read_csv_trajectory(const std::filesystem::path& path,
                               std::optional<size_t> frames = std::nullopt);

/// Reads any of these formats, detected by content, or GPS fixes (gps.h) as positions on the earth.
/// Throws Error(usage) for other files.
Trajectory read_any_trajectory(const std::filesystem::path& path);

/// As read_any_trajectory, with GPS fixes projected to the plane that touches the earth at the
/// first one. For a file without times, `times`, if not empty, has them: one per line and pose
/// (KITTI's times.txt). Times must increase. Throws Error(usage) for other files, or if both files
/// have times.
Trajectory read_trajectory(const std::filesystem::path& path, const std::filesystem::path& times);

/// Reads the times of the poses from a file. Throws Error(data) if their numbers differ.
void add_times(Trajectory& trajectory, const std::filesystem::path& times);

/// Throws Error(data), with the line, if a time is not after the previous one.
void require_rising_times(const Trajectory& trajectory);

}  // namespace vpr
