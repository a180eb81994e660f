// Where frames were taken, and the walls around them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vpr {

/// Columns of a CSV file of poses, by name and in any order; others are not looked at.
struct PoseColumns {
  size_t frame = 0;
  size_t x = 0;
  size_t y = 0;
  std::optional<size_t> heading;
  std::optional<size_t> floor;
};

/// Nothing without frame, x and y.
std::optional<PoseColumns> find_pose_columns(const std::vector<std::string>& header);

/// Metres on the plan.
struct RoutePoint {
  double x = 0;
  double y = 0;
  std::string floor;  ///< empty where the file names none
};

struct WallLine {
  RoutePoint from;
  RoutePoint to;
};

/// A CSV with columns frame, x, y and maybe floor: where each frame was taken, up to the last that
/// has a line; nothing for frames without one. Throws Error(input) if it can't be read,
/// Error(data), naming the line, if it is damaged or a frame is beyond ten millions.
std::vector<std::optional<RoutePoint>> read_route(const std::filesystem::path& path);

/// A CSV with columns place, x, y and maybe floor, one line a view: the first of each place, in the
/// order of the file. Throws like read_route.
std::vector<RoutePoint> read_place_positions(const std::filesystem::path& path);

/// A CSV with columns x0, y0, x1, y1 and maybe floor. Throws like read_route.
std::vector<WallLine> read_walls(const std::filesystem::path& path);

}  // namespace vpr
