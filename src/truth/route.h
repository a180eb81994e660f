// Positions of frames as CSV: poses for ground truth, routes and walls for maps, distances
// traveled.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sequence/sequence.h"
#include "truth/gps.h"

namespace vpr {

struct Monitor;

/// A row of a CSV of poses.
struct CsvPose {
  Pose pose;                 ///< position: x, y and 0, or on the earth (gps.h)
  bool is_on_earth = false;  ///< the file has latitudes and longitudes
  std::string floor;         ///< empty without this column
};

/// The number of frames of the sequence: `frames` or, if unknown, the largest frame in the file
/// plus one, which must be below `most_frames`.
struct PoseCsvRules {
  std::optional<size_t> frames;
  size_t most_frames = 10'000'000;
};

/// One entry per frame; nullopt for a frame without a line or, in a file with latitudes and
/// longitudes (gps.h) instead of x and y, without a fix. `path` may end in a range
/// (poses.csv@100:200): frames are then counted from its first frame with its step, and others are
/// skipped. Frames may be in any order; other columns than these, heading and floor are ignored.
/// Throws Error(input) if the file cannot be read; Error(data), with the line, if it is damaged, a
/// frame is out of range or listed twice, or the range has another number of frames.
std::vector<std::optional<CsvPose>> read_pose_csv(const std::filesystem::path& path,
                                                  const PoseCsvRules& rules);

/// In meters on the plan.
struct RoutePoint {
  double x = 0;
  double y = 0;
  std::string floor;  ///< empty if the file has none
};

/// A straight wall between two points.
struct WallLine {
  RoutePoint from;
  RoutePoint to;
};

/// The position of each frame up to the last one with a line; nullopt for frames without one.
using Route = std::vector<std::optional<RoutePoint>>;

/// Several routes on one map, in one plane.
struct Routes {
  std::vector<Route> routes;
  bool is_gps = false;  ///< x and y are meters east and north of the first fix of the first file
};

/// One route per path, empty for an empty path. For files with latitudes and longitudes, x and y
/// are meters east and north of the first fix. Throws as read_pose_csv does, and Error(data) if
/// only some files have latitudes.
Routes read_routes(const std::vector<std::filesystem::path>& paths);

/// Reads a CSV with columns place, x, y and optionally floor, one view per line: returns the first
/// view of each place, in the order of the file. Throws Error(input) if it cannot be read;
/// Error(data), with the line, if it is damaged.
std::vector<RoutePoint> read_place_positions(const std::filesystem::path& path);

/// A CSV with columns x0, y0, x1, y1 and optionally floor. Throws as read_place_positions does.
std::vector<WallLine> read_walls(const std::filesystem::path& path);

/// Distance in meters from the first frame to each frame of the sequence along the straight lines
/// between their positions in a CSV (read_pose_csv) with the poses of the recording. Warns and
/// returns an empty vector if a frame has no pose. Throws Error(data) if positions are too far
/// apart for meters; also throws as read_pose_csv does.
std::vector<double> read_traveled(const std::filesystem::path& path, const Sequence& sequence,
                                  const Monitor& monitor);

}  // namespace vpr
