// Where frames were taken, the distance travelled, and the walls around them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "images/selection.h"

namespace vpr {

struct Monitor;

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

/// Throws as read_pose_csv does. Of a file with latitudes and longitudes x and y are metres to the
/// east and north of its first fix.
Route read_route(const std::filesystem::path& path);

/// Several of one map, in one plane.
struct Routes {
  std::vector<Route> routes;
  bool is_gps = false;  ///< x and y are metres east and north of the first fix of the first file
};

/// One route a path, empty for an empty path. Throws as read_pose_csv does, and Error(data) where
/// some files have latitudes and others metres.
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
