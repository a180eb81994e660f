// Positions of frames as CSV: poses for ground truths, routes and walls for maps, distances
// traveled.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sequence/selection.h"
#include "truth/gps.h"

namespace vpr {

struct Monitor;

/// A row of a CSV of poses.
struct CsvPose {
  Pose pose;                 ///< position: x, y and 0, or on the earth (gps.h)
  bool is_on_earth = false;  ///< the file has latitudes and longitudes
  std::string floor;         ///< empty without such a column
};

/// How many frames the sequence has: `frames` of them or, where that is not known, one more than
/// the largest that is named, which must be below `most_frames`.
struct PoseCsvRules {
  std::optional<size_t> frames;
  size_t most_frames = 10'000'000;
};

/// One entry a frame; nothing for a frame without a line or, in a file that has latitudes and
/// longitudes (gps.h) instead of x and y, without a fix. `path` may end in a range
/// (poses.csv@100:200): then its frames count from the range's first, in its steps, and others are
/// left out. Frames may stand in any order; other columns than these, heading and floor are not
/// looked at. Throws Error(input) if the file can't be read, Error(data), naming the line, if
/// it is damaged, a frame is out of range or given twice, or the range has another number of
/// frames.
std::vector<std::optional<CsvPose>> read_pose_csv(const std::filesystem::path& path,
                                                  const PoseCsvRules& rules);

/// Metres on the plan.
struct RoutePoint {
  double x = 0;
  double y = 0;
  std::string floor;  ///< empty where the file names none
};

/// A straight wall, from end to end.
struct WallLine {
  RoutePoint from;
  RoutePoint to;
};

/// Where each frame was taken, up to the last that has a line; nothing for frames without one.
using Route = std::vector<std::optional<RoutePoint>>;

/// Several of one map, in one plane.
struct Routes {
  std::vector<Route> routes;
  bool is_gps = false;  ///< x and y are metres east and north of the first fix of the first file
};

/// One route per path, empty for an empty path. x and y of files with latitudes and longitudes are
/// meters east and north of the first fix. Throws the errors of read_pose_csv, and Error(data) if
/// only some files have latitudes.
Routes read_routes(const std::vector<std::filesystem::path>& paths);

/// A CSV with columns place, x, y and maybe floor, one line a view: the first of each place, in the
/// order of the file. Throws Error(input) if it can't be read, Error(data), naming the line, if it
/// is damaged.
std::vector<RoutePoint> read_place_positions(const std::filesystem::path& path);

/// A CSV with columns x0, y0, x1, y1 and maybe floor. Throws like that.
std::vector<WallLine> read_walls(const std::filesystem::path& path);

/// Meters from the first frame to each of `frames` frames along the straight lines between their
/// positions, which read_pose_csv reads. Warns and returns an empty vector where a frame has no
/// pose. With a `replay` of `frames` frames, the file has the poses of the recording. Throws
/// Error(data) where positions are too far apart for meters, and the errors of read_pose_csv.
std::vector<double> read_travelled(const std::filesystem::path& path, size_t frames,
                                   const Monitor& monitor,
                                   const std::optional<Replay>& replay = {});

}  // namespace vpr
