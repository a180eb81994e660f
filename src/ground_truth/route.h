// Where frames were taken, and the walls around them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace vpr {

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
/// Throws as read_pose_csv does.
std::vector<std::optional<RoutePoint>> read_route(const std::filesystem::path& path);

/// A CSV with columns place, x, y and maybe floor, one line a view: the first of each place, in the
/// order of the file. Throws Error(input) if it can't be read, Error(data), naming the line, if it
/// is damaged.
std::vector<RoutePoint> read_place_positions(const std::filesystem::path& path);

/// A CSV with columns x0, y0, x1, y1 and maybe floor. Throws like that.
std::vector<WallLine> read_walls(const std::filesystem::path& path);

}  // namespace vpr
