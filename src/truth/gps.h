#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "truth/formats.h"
#include "truth/text_file.h"
#include "truth/trajectory.h"

namespace vpr {

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

/// The names of the columns in a header.
struct GpsColumns {
  std::string latitude;
  std::string longitude;
};

/// Finds lat or latitude, and lon, lng, long or longitude, in any case. Nullopt if one is missing.
std::optional<GpsColumns> find_gps_columns(const std::vector<std::string>& header);

/// The place of the current row; nullopt if both fields are empty because there was no fix. Degrees
/// have a decimal point, and longitudes are from -180 to 360. Throws Error(data), with the line,
/// for any other text; for a latitude beyond 90, the message asks whether the columns are swapped.
std::optional<Geographic> read_fix(const NamedRows& rows, const GpsColumns& columns);

/// The argument's path has the fixes of the query, its `reference` those of the training sequence.
/// Each is a CSV (read_fixes), with a range of frames if the sequence had one; by time as for
/// trajectories (association.h). Distances are straight lines between points on the ellipsoid,
/// without heights. Warns if more than half of the frames of a side have no fix; throws Error(data)
/// if none has, and as the readers do.
std::string read_gps(GroundTruthBuilder& builder);

/// Whether the first line is a CSV header with latitudes and longitudes.
bool is_gps(const FileStart& start);

/// The fixes of one side on the earth: a CSV with columns for latitude, longitude and optionally
/// heading, in degrees. A line belongs to
/// - the frame in its column `frame`;
/// - or the image in its column `image` (or name, file, filename), which requires `images`, the
///   folder or list of the sequence; names are compared without folders, and every line must name
///   an image of the sequence, which may have images without a line;
/// - or the time in its column `time` (or timestamp), as numbers or as dates (UTC by default);
/// - otherwise line i belongs to frame i.
/// Lines without a fix have no pose. `frames`: the number of frames of the sequence, if known, for
/// lines with frame numbers. Positions are on the earth. A range after the path selects lines, or
/// frames by their numbers. Throws Error(input) if a file cannot be read, Error(usage) for images
/// by name without `images`, Error(data), with the line, if it is damaged.
Trajectory read_fixes(const std::filesystem::path& path, const std::filesystem::path& images = {},
                      std::optional<size_t> frames = std::nullopt);

/// Transforms a trajectory on the earth so that its first fix is 0, 0, 0, and x, y and z are meters
/// to the east, north and up. Other trajectories do not change.
void level(Trajectory& trajectory);

}  // namespace vpr
