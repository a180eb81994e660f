#include "truth/positions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/column_names.h"
#include "base/converters.h"
#include "base/error.h"
#include "base/rows.h"
#include "base/text.h"
#include "recordings/sequence_source.h"
#include "truth/formats.h"
#include "truth/layouts.h"
#include "truth/times.h"

namespace vpr {

namespace fs = std::filesystem;

namespace {

/// WGS84: semi-major axis in meters, and flattening.
constexpr double kSemiMajorAxis = 6378137;
constexpr double kFlattening = 1 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2 - kFlattening);

bool is_pose_header(const std::vector<std::string>& header) {
  return has_columns(header, {"frame", "x", "y"});
}

double read_degrees(const Rows& rows, std::string_view column, std::string_view what) {
  const auto value = rows.number(column);
  if (!value)
    rows.fail("the {} \"{}\" is not a number in degrees{}. Leave both empty if there is no fix",
              what, rows.text(column), decimal_comma_hint(rows.text(column)));
  return *value;
}

// Whether a letter, if there is one, says that the latitude is south or the longitude west.
bool is_negative(const Rows& rows, std::string_view column) {
  std::string letter = lower_case(std::string(rows.text(column)));
  for (const std::string_view word : {"north", "south", "east", "west"})
    if (letter == word) letter.resize(1);
  const bool is_other = letter == column.substr(2);  // "n/s", "e/w"
  if (!letter.empty() && !is_other && letter != column.substr(0, 1))
    rows.fail("the letter \"{}\" of its column {} is unknown", rows.text(column), column);
  return is_other;
}

// Nullopt if both cells are missing, or 0: the receiver had no fix.
std::optional<Geographic> read_fix(const Rows& rows) {
  const std::string_view latitude = rows.text("lat");
  const std::string_view longitude = rows.text("lon");
  if (is_missing(latitude) && is_missing(longitude)) return std::nullopt;
  Geographic place{read_degrees(rows, "lat", "latitude"), read_degrees(rows, "lon", "longitude")};
  if (is_negative(rows, "n/s")) place.latitude_deg = -std::abs(place.latitude_deg);
  if (is_negative(rows, "e/w")) place.longitude_deg = -std::abs(place.longitude_deg);
  if (place.latitude_deg == 0 && place.longitude_deg == 0) return std::nullopt;
  if (std::abs(place.latitude_deg) > 90)
    rows.fail("the latitude {} is beyond 90 degrees{}", latitude,
              std::abs(place.longitude_deg) <= 90 ? "; are latitude and longitude swapped?" : "");
  if (!(place.longitude_deg >= -180 && place.longitude_deg <= 360))
    rows.fail("the longitude {} is not within -180 and 180 degrees", longitude);
  return place;
}

// Equal numbers are one floor, however they are written. Empty if unknown.
std::string floor_of(const Rows& rows) {
  const std::string_view text = rows.text("floor");
  if (is_missing(text)) return "";
  const auto number = parse_real(text);
  return number ? fmt::format("{}", *number + 0.0) : std::string(text);
}

// The pose of the current row: a fix, or x and y. A heading may be empty.
std::optional<Pose> read_pose(const Rows& rows, bool is_fix) {
  Pose pose;
  if (is_fix) {
    const auto place = read_fix(rows);
    if (!place) return std::nullopt;
    pose.position = earth_position(*place);
  } else {
    if (is_missing(rows.text("x")) && is_missing(rows.text("y"))) return std::nullopt;
    pose.position = {rows.real("x"), rows.real("y"), rows.has("z") ? rows.real("z") : 0};
  }
  if (!is_missing(rows.text("heading"))) pose.heading_deg = rows.real("heading");
  pose.area = floor_of(rows);
  return pose;
}

// Latitudes within pi / 2 and longitudes within pi are radians, or lie in the Gulf of Guinea.
void check_degrees(Rows& rows) {
  const auto names_unit = [](const std::string& name) {
    const std::string text = lower_case(name);
    return text.find("deg") < text.size() || text.find("rad") < text.size() ||
           text.find("\xc2\xb0") < text.size();
  };
  if (std::ranges::any_of(rows.header(), names_unit)) return;
  std::set<std::string_view> latitudes;
  bool are_radians = true;
  while (rows.next()) {
    const auto latitude = rows.number("lat");
    const auto longitude = rows.number("lon");
    if (!latitude || !longitude || (*latitude == 0 && *longitude == 0)) continue;
    latitudes.insert(rows.text("lat"));
    are_radians = are_radians && std::abs(*latitude) <= std::numbers::pi / 2 &&
                  std::abs(*longitude) <= std::numbers::pi;
  }
  if (are_radians && latitudes.size() > 1)
    rows.fail(
        "all latitudes are within pi / 2 and all longitudes within pi, as radians are. Name the "
        "columns lat_rad and lon_rad, or lat_deg and lon_deg");
}

std::vector<int64_t> times_of_fixes(Rows& rows, const FrameRange& range) {
  TimeReader reader(unit_of_times(rows, "time"));
  std::vector<int64_t> times;
  for (size_t row = 0; rows.next(); ++row)
    if (frame_in_range(range, row))
      times.push_back(reader.read(rows.location(), rows.text("time")));
  return times;
}

void read_fixes_in_order(Rows& rows, const FrameRange& range, Trajectory& found) {
  for (size_t row = 0; rows.next(); ++row) {
    const auto pose = fix_pose(rows);
    if (!frame_in_range(range, row)) continue;
    found.poses.push_back(pose);
    found.lines.push_back(rows.line());
  }
}

}  // namespace

std::array<double, 3> earth_position(const Geographic& place) {
  const double latitude = place.latitude_deg * std::numbers::pi / 180;
  const double longitude = std::remainder(place.longitude_deg, 360.0) * std::numbers::pi / 180;
  const double sine = std::sin(latitude);
  // The distance from the earth's axis along the normal of the ellipsoid.
  const double normal = kSemiMajorAxis / std::sqrt(1 - kEccentricity2 * sine * sine);
  const double from_axis = normal * std::cos(latitude);
  return {from_axis * std::cos(longitude), from_axis * std::sin(longitude),
          normal * (1 - kEccentricity2) * sine};
}

Geographic place_of_utm(double east, double north, int zone, bool is_southern) {
  constexpr double kScale = 0.9996;
  constexpr double n = kFlattening / (2 - kFlattening);  // the third flattening
  constexpr double n2 = n * n;
  constexpr double n3 = n2 * n;
  constexpr double n4 = n3 * n;
  constexpr double kRadius = kSemiMajorAxis / (1 + n) * (1 + n2 / 4 + n4 / 64);
  constexpr std::array<double, 4> kGrid = {n / 2 - 2 * n2 / 3 + 37 * n3 / 96 - n4 / 360,
                                           n2 / 48 + n3 / 15 - 437 * n4 / 1440,
                                           17 * n3 / 480 - 37 * n4 / 840, 4397 * n4 / 161280};
  constexpr std::array<double, 4> kLatitude = {2 * n - 2 * n2 / 3 - 2 * n3 + 116 * n4 / 45,
                                               7 * n2 / 3 - 8 * n3 / 5 - 227 * n4 / 45,
                                               56 * n3 / 15 - 136 * n4 / 35, 4279 * n4 / 630};
  const double up = (north - (is_southern ? 1e7 : 0)) / (kScale * kRadius);
  const double right = (east - 5e5) / (kScale * kRadius);
  double sphere_up = up;
  double sphere_right = right;
  for (size_t j = 0; j < kGrid.size(); ++j) {
    const auto twice = static_cast<double>(2 * (j + 1));
    sphere_up -= kGrid[j] * std::sin(twice * up) * std::cosh(twice * right);
    sphere_right -= kGrid[j] * std::cos(twice * up) * std::sinh(twice * right);
  }
  const double conformal = std::asin(std::sin(sphere_up) / std::cosh(sphere_right));
  double latitude = conformal;
  for (size_t j = 0; j < kLatitude.size(); ++j)
    latitude += kLatitude[j] * std::sin(static_cast<double>(2 * (j + 1)) * conformal);
  const double from_meridian = std::atan2(std::sinh(sphere_right), std::cos(sphere_up));
  return {latitude * 180 / std::numbers::pi,
          6.0 * zone - 183 + from_meridian * 180 / std::numbers::pi};
}

LocalPlane::LocalPlane(const std::array<double, 3>& origin) : origin_(origin) {
  const double from_axis = std::sqrt(origin[0] * origin[0] + origin[1] * origin[1]);
  // At a pole, east is the direction of east at points of longitude 0 nearby.
  const double cosine = from_axis > 0 ? origin[0] / from_axis : 1;
  const double sine = from_axis > 0 ? origin[1] / from_axis : 0;
  // The normal of the ellipsoid.
  const double rise = origin[2] / (1 - kEccentricity2);
  const double length = std::sqrt(from_axis * from_axis + rise * rise);
  const double level = from_axis / length;
  const double steep = rise / length;
  axes_ = {-sine,          cosine,       0,    -steep * cosine, -steep * sine, level,
           level * cosine, level * sine, steep};
}

std::array<double, 3> LocalPlane::local(const std::array<double, 3>& earth) const {
  std::array<double, 3> position{};
  for (size_t row = 0; row < 3; ++row)
    for (size_t k = 0; k < 3; ++k) position[row] += axes_[3 * row + k] * (earth[k] - origin_[k]);
  return position;
}

void flatten(Trajectory& trajectory, std::optional<LocalPlane>& plane) {
  if (!std::exchange(trajectory.is_on_earth, false)) return;
  for (auto& pose : trajectory.poses) {
    if (!pose) continue;
    if (!plane) plane.emplace(pose->position);
    pose->position = plane->local(pose->position);
  }
}

bool is_pose_table(const std::vector<std::string>& header) {
  return is_pose_header(header) && !has_columns(header, {"qx", "qy", "qz", "qw"});
}

std::optional<Pose> fix_pose(const Rows& rows) { return read_pose(rows, /*is_fix=*/true); }

bool is_gps_header(const std::vector<std::string>& header) {
  return has_columns(header, {"lat", "lon"});
}

void check_meters(const Rows& rows, const Trajectory& found) {
  constexpr double kFewDegrees = 0.1;
  constexpr size_t kFewPoses = 10;
  const auto names_unit = [](const std::string& cell) {
    const auto name = parse_column_name(cell, "x");
    return name && name->unit;
  };
  if (found.is_on_earth || found.poses.size() - count_unknown(found.poses) < kFewPoses ||
      std::ranges::any_of(rows.header(), names_unit))
    return;
  const auto first =
      std::ranges::find_if(found.poses, [](const auto& pose) { return pose.has_value(); });
  const auto [x, y, z] = extents_of(found.poses);
  const auto& position = (*first)->position;
  const double farther = std::max(std::abs(position[0]), std::abs(position[1]));
  if (x + y > 0 && std::max(x, y) < kFewDegrees && farther > 1 && farther <= 360)
    rows.fail(
        "its positions near {:g}, {:g} extend over less than {} m. If they are latitudes and "
        "longitudes, {} lat and lon; if they are meters, x_m and y_m",
        position[0], position[1], kFewDegrees,
        rows.header().empty() ? "add a first line that names all columns, these" : "name them");
}

Trajectory read_pose_csv(const fs::path& path, std::optional<size_t> frames, bool with_times) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  const std::vector<std::string> header = open_start(source.path).header;
  const bool are_fixes = is_gps_header(header) && !is_pose_header(header);
  Rows rows(source.path, path.string(),
            are_fixes ? RowRules{.columns = {"frame", "lat", "lon", "time", "heading", "floor",
                                             "n/s", "e/w"},
                                 .needed = 3,
                                 .has_others = true}
                      : RowRules{{"frame", "x", "y", "z", "time", "heading", "floor"}, 3});
  const auto in_range = frame_count(source.range);
  if (in_range && frames && *in_range != *frames)
    rows.fail("its range has {}, but the sequence has {}", counted(*in_range, "frame"), *frames);
  Trajectory found;
  found.name = path.string();
  found.is_on_earth = are_fixes;
  found.has_heights = rows.has("z");
  found.has_floors = rows.has("floor");
  found.poses.resize(frames.value_or(0));
  with_times = with_times && rows.has("time");
  if (are_fixes) check_degrees(rows);
  TimeReader times(with_times ? unit_of_times(rows, "time") : std::nullopt);
  std::set<size_t> listed;
  while (rows.next()) {
    const size_t number = rows.frame("frame");
    const auto frame = frame_in_range(source.range, number);
    if (!frame) continue;
    if (!frames && *frame >= most_frames_of(rows.size()))
      rows.fail("frame {} is too large for {}; pass the number of frames", number,
                counted(rows.size(), "line"));
    if (frames && *frame >= *frames)
      rows.fail("frame {} is out of range; there are {} frames{}", number, *frames,
                source.range.is_all() ? range_hint(source.path) : "");
    if (!listed.insert(*frame).second) rows.fail("frame {} is listed twice", number);
    found.poses.resize(std::max<size_t>(found.poses.size(), *frame + 1));
    found.poses[*frame] = read_pose(rows, are_fixes);
    if (!with_times) continue;
    found.times_ns.resize(found.poses.size());
    found.times_ns[*frame] = times.read(rows.location(), rows.text("time"));
  }
  if (listed.size() < found.poses.size()) found.times_ns.clear();
  check_meters(rows, found);
  return found;
}

Trajectory read_fixes(const fs::path& path, std::optional<size_t> frames, bool needs_times) {
  const FileStart start = open_start(path);
  if (start.is_folder)
    throw Error(ErrorKind::usage,
                "{} is a folder. Write the GPS positions of its images to a CSV with "
                "scripts/convert/exif.py",
                path.string());
  if (!is_gps_header(start.header)) {
    if (start.layout != nullptr && start.layout->has("lat"))
      return read_layout(path, *start.layout, needs_times);
    refuse_convertible(start.path, start.bytes);
    throw Error(ErrorKind::data, "{}: is not a CSV with latitudes and longitudes{}", path.string(),
                is_pose_header(start.header) ? "; its positions are in meters" : "");
  }
  const SequenceArgument source = parse_sequence_argument(path.string());
  Rows rows(source.path, path.string(),
            {.columns = {"lat", "lon", "frame", "image", "time", "heading", "floor", "n/s", "e/w"},
             .needed = 2,
             .has_others = true});
  if (rows.has("frame")) {
    if (is_pose_header(rows.header()))
      rows.fail("has positions in meters (x, y) and latitudes; remove the columns x and y");
    return read_pose_csv(path, frames, needs_times);
  }
  check_degrees(rows);
  Trajectory found;
  found.name = path.string();
  found.is_on_earth = true;
  found.has_floors = rows.has("floor");
  read_fixes_in_order(rows, source.range, found);
  read_names(rows, source.range, found);
  try {
    if (rows.has("time")) found.times_ns = times_of_fixes(rows, source.range);
  } catch (const Error& error) {
    if (needs_times || error.kind() != ErrorKind::data) throw;
  }
  return found;
}

Routes read_routes(const std::vector<fs::path>& paths) {
  Routes found;
  std::optional<LocalPlane> plane;
  fs::path meters;  // a file with x and y
  fs::path gps;     // a file with latitudes
  for (const fs::path& path : paths) {
    Trajectory read = read_pose_csv(path);
    (read.is_on_earth ? gps : meters) = path;
    if (!meters.empty() && !gps.empty())
      throw Error(
          ErrorKind::data,
          "{} has latitudes and longitudes, but {} has x and y in meters. Use one of them for both",
          gps.string(), meters.string());
    flatten(read, plane);
    Route& route = found.routes.emplace_back();
    for (const auto& pose : read.poses) {
      route.emplace_back();
      if (pose) route.back() = {pose->position[0], pose->position[1], pose->area};
    }
  }
  found.is_gps = plane.has_value();
  return found;
}

std::vector<RoutePoint> read_place_positions(const fs::path& path) {
  Rows rows(path, path.string(), {{"place", "x", "y", "view", "heading", "floor"}, 3});
  std::vector<RoutePoint> places;
  std::set<std::string_view> seen;
  while (rows.next()) {
    if (seen.insert(rows.text("place")).second)
      places.push_back({rows.real("x"), rows.real("y"), floor_of(rows)});
  }
  return places;
}

std::vector<WallLine> read_walls(const fs::path& path) {
  Rows rows(path, path.string(), {{"x0", "y0", "x1", "y1", "floor", "kind"}, 4});
  std::vector<WallLine> walls;
  while (rows.next()) {
    const std::string floor = floor_of(rows);
    walls.push_back(
        {{rows.real("x0"), rows.real("y0"), floor}, {rows.real("x1"), rows.real("y1"), floor}});
  }
  return walls;
}

std::vector<double> read_traveled(const fs::path& path, const Sequence& sequence) {
  const Poses poses =
      selected(read_pose_csv(path, sequence.recorded_frames()).poses, sequence.selection);
  if (count_unknown(poses) > 0) return {};
  std::vector<double> traveled_m;
  for (size_t frame = 0; frame < sequence.frames; ++frame) {
    double square = 0;
    for (size_t k = 0; frame > 0 && k < 3; ++k) {
      const double step = poses[frame]->position[k] - poses[frame - 1]->position[k];
      square += step * step;
    }
    // Correctly rounded on every machine, unlike hypot.
    traveled_m.push_back(frame == 0 ? 0 : traveled_m.back() + std::sqrt(square));
  }
  if (!traveled_m.empty() && !std::isfinite(traveled_m.back()))
    throw Error(ErrorKind::data, "{}: its positions are too far apart for meters", path.string());
  return traveled_m;
}

}  // namespace vpr
