// Ground truth by latitude and longitude: GPS fixes as CSV, and positions on the earth in meters.
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

/// Degrees north and east, as GPS has them (WGS84).
struct Geographic {
  double latitude_deg = 0;   ///< -90 to 90
  double longitude_deg = 0;  ///< any; whole turns make no difference
};

/// Metres from the centre of the earth: towards 0 N 0 E, towards 0 N 90 E and towards the north
/// pole, of a point on the ellipsoid (WGS84), whose height is left out. The straight line
/// between two points is shorter than the way on the ground by 1 mm of 10 km, and by 1 m of 100 km,
/// everywhere on earth.
std::array<double, 3> earth_position(const Geographic& place);

/// A plane that touches the earth in its origin.
class LocalPlane {
 public:
  /// `origin` as earth_position() gives it.
  explicit LocalPlane(const std::array<double, 3>& origin);

  /// Metres east, north and up of the origin, of a position as earth_position() gives it. It is a
  /// turn and a shift, so that distances stay what they are; those along the plane alone are
  /// shortened by at most 1.3 parts in a million 10 km from the origin.
  std::array<double, 3> local(const std::array<double, 3>& earth) const;

 private:
  std::array<double, 3> origin_;
  std::array<double, 9> axes_;  ///< east, north and up, row by row
};

/// What a header calls them.
struct GpsColumns {
  std::string latitude;
  std::string longitude;
};

/// Those of lat or latitude, and of lon, lng, long or longitude, in small or capital letters.
/// Nothing if one is missing.
std::optional<GpsColumns> find_gps_columns(const std::vector<std::string>& header);

/// The place of the present row; nothing where both fields are empty: there was no fix. Degrees
/// have a decimal point, and longitudes are from -180 to 360. Throws Error(data), with the line,
/// for any other text; for a latitude beyond 90 it asks whether the two columns are swapped.
std::optional<Geographic> read_fix(const NamedRows& rows, const GpsColumns& columns);

/// The argument's path has the fixes of the query, its `reference` those of the training sequence;
/// each is a CSV (read_fixes), with a range of frames where the sequence had one. By time as
/// trajectories (association.h). Distances are straight lines between points on the ellipsoid,
/// heights left out. Warns where more than half of the frames of a side have no fix; throws
/// Error(data) where none has, and as the readers do.
std::string read_gps(GroundTruthBuilder& builder);

/// Whether the first line is the header of a CSV that names latitudes and longitudes.
bool is_gps(const FileStart& start);

/// The fixes of one side on the earth: a CSV whose header names latitude and longitude, and
/// maybe heading, in degrees. A line is of the frame in its column `frame`; or of the image in its
/// column `image` (or name, file, filename), where `images`, the folder or list of the sequence, is
/// given: names without folders count, and every line must name an image of the sequence, which may
/// have images without a line; or of the moment in its column `time` (or timestamp), as numbers or
/// as dates (UTC where they name no time zone); or line i is that of frame i. Lines without a fix
/// give no pose. `frames`: how many the sequence has, if that is known, where lines are of frames
/// by their numbers. Positions are on the earth. A range behind the path picks lines, or frames by
/// their numbers. Throws Error(input) if a file can't be read, Error(usage) for images by name
/// without `images`, Error(data), naming the line, if it is damaged.
Trajectory read_fixes(const std::filesystem::path& path, const std::filesystem::path& images = {},
                      std::optional<size_t> frames = std::nullopt);

/// Turns and shifts a trajectory on the earth so that its first fix is 0, 0, 0, and x, y and z are
/// metres to the east, north and up; leaves any other as it is.
void level(Trajectory& trajectory);

}  // namespace vpr
