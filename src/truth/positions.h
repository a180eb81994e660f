// Positions as CSV, in meters or as latitude and longitude: poses and fixes of frames, and routes,
// places and walls for maps.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/sequence.h"
#include "truth/trajectory.h"

namespace vpr {

class Rows;

/// Degrees north and east (WGS84).
struct Geographic {
  double latitude_deg = 0;   ///< -90 to 90
  double longitude_deg = 0;  ///< any; whole turns are equivalent
};

/// A point on the WGS84 ellipsoid, without height, in meters from the center of the earth toward 0
/// N 0 E, toward 0 N 90 E and toward the north pole. The straight line between two points is
/// shorter than the distance on the ground by 1 mm at 10 km and by 1 m at 100 km, everywhere on
/// earth.
std::array<double, 3> earth_position(const Geographic& place);

/// Meters east and north in a zone of UTM (WGS84), 1 to 60, of one hemisphere, as a place: the
/// series of Krueger to the fourth order (Karney 2011, equations 36 to 38), exact to 0.1 mm within
/// the zone.
Geographic place_of_utm(double east, double north, int zone, bool is_southern);

/// The plane that touches the earth at its origin.
class LocalPlane {
 public:
  /// `origin` as returned by earth_position().
  explicit LocalPlane(const std::array<double, 3>& origin);

  /// Meters east, north and up from the origin, for a position returned by earth_position(). This
  /// is a rigid motion, which preserves distances; distances in the plane alone are shorter by at
  /// most 1.3 parts per million at 10 km from the origin.
  std::array<double, 3> local(const std::array<double, 3>& earth) const;

 private:
  std::array<double, 3> origin_;
  std::array<double, 9> axes_;  ///< rows are the directions east, north and up
};

/// Moves positions on the earth to `plane`, which touches the earth at the first of them unless it
/// is set. Others stay.
void flatten(Trajectory& trajectory, std::optional<LocalPlane>& plane);

/// Whether the header of a table has frame, x and y, without a quaternion: a file for
/// read_pose_csv.
bool is_pose_table(const std::vector<std::string>& header);
/// Whether it has lat or latitude, and lon, lng, long or longitude.
bool is_gps_header(const std::vector<std::string>& header);

/// A CSV with a column `frame`, x and y or latitude and longitude, and optionally z, heading and
/// floor. Columns other than these and time are refused, except next to latitudes. One pose per
/// frame, on the earth for latitudes; nullopt for a frame without a line, or without a position:
/// empty, NaN, or latitude and longitude 0. `path` may end in a range (poses.csv@100:200): frames
/// are then counted from its first frame with its step, and others are skipped. Frames may be in
/// any order. Throws Error(input) if the file cannot be read; Error(data), with the line, if it is
/// damaged, a frame is out of range or listed twice, or the range has another number of frames.
/// `frames`: the number of frames of the sequence; without it, the largest frame in the file plus
/// one, at most most_frames_of(lines). `with_times`: also reads the column time (or timestamp);
/// no times if a frame has no line.
Trajectory read_pose_csv(const std::filesystem::path& path,
                         std::optional<size_t> frames = std::nullopt, bool with_times = false);

/// Latitudes and longitudes of some kilometers are all within a tenth of a degree: throws
/// Error(data) for 10 or more positions in meters that look like them.
void check_meters(const Rows& rows, const Trajectory& found);

/// The fixes of one side on the earth: a CSV with columns for latitude, longitude and optionally
/// heading, in degrees. Degrees have a decimal point, and longitudes are from -180 to 360. A line
/// belongs to
/// - the frame in its column `frame`;
/// - or the image in its column `image` (or another column of names, by choose_names);
/// - or the time in its column `time` (or timestamp), as numbers or as dates (UTC by default);
/// - otherwise line i belongs to frame i.
/// A line with neither latitude nor longitude, or with 0 for both, has no pose. `frames`: the
/// number of frames of the sequence, if known, for lines with frame numbers. `needs_times`: times
/// that cannot be read are refused, not omitted. A range after the path
/// selects lines, or frames by their numbers. Throws Error(input) if a file cannot be read;
/// Error(data), with the line, if it is damaged, and for degrees that are radians (all latitudes
/// within pi / 2 and longitudes within pi) unless the header names their unit.
Trajectory read_fixes(const std::filesystem::path& path,
                      std::optional<size_t> frames = std::nullopt, bool needs_times = true);

/// The pose of the fix in the current row, on the earth; nullopt without a fix.
std::optional<Pose> fix_pose(const Rows& rows);

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

/// One route per path. Throws as read_pose_csv does, and Error(data) if only some files have
/// latitudes.
Routes read_routes(const std::vector<std::filesystem::path>& paths);

/// Reads a CSV with columns place, x, y and optionally floor, one view per line: returns the first
/// view of each place, in the order of the file. Throws Error(input) if it cannot be read;
/// Error(data), with the line, if it is damaged.
std::vector<RoutePoint> read_place_positions(const std::filesystem::path& path);

/// A CSV with columns x0, y0, x1, y1 and optionally floor. Throws as read_place_positions does.
std::vector<WallLine> read_walls(const std::filesystem::path& path);

/// Distance in meters from the first frame to each frame of the sequence along the straight lines
/// between their positions in a CSV (read_pose_csv) with the poses of the recording. Empty if a
/// frame has no pose. Throws Error(data) if positions are too far apart for meters; also throws as
/// read_pose_csv does.
std::vector<double> read_traveled(const std::filesystem::path& path, const Sequence& sequence);

}  // namespace vpr
