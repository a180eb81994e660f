#include "truth/gps.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "base/converters.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "sequence/sequence_source.h"
#include "truth/association.h"
#include "truth/builder.h"
#include "truth/poses.h"
#include "truth/text_file.h"
#include "truth/times.h"

namespace vpr {
namespace {

/// WGS84: semi-major axis in meters, and flattening.
constexpr double kSemiMajorAxis = 6378137;
constexpr double kFlattening = 1 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2 - kFlattening);

std::string small_letters(std::string text) {
  for (char& letter : text)
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  return text;
}

std::string find_name(const std::vector<std::string>& header,
                      const std::vector<std::string_view>& names) {
  const auto found = std::find_if(header.begin(), header.end(), [&](const std::string& column) {
    return std::find(names.begin(), names.end(), small_letters(column)) != names.end();
  });
  return found == header.end() ? "" : *found;
}

double degrees(const FileLocation& location, const char* what, std::string_view text) {
  const auto value = parse_real(text);
  if (!value)
    location.fail(fmt::format(
        "the {} \"{}\" is not a number in degrees (leave both empty where there is no fix)", what,
        text));
  return *value;
}

Geographic parse_place(const FileLocation& location, std::string_view latitude,
                       std::string_view longitude) {
  const Geographic place{degrees(location, "latitude", latitude),
                         degrees(location, "longitude", longitude)};
  if (std::abs(place.latitude_deg) > 90)
    location.fail(fmt::format(
        "the latitude {} is beyond 90 degrees{}", latitude,
        std::abs(place.longitude_deg) <= 90 ? "; are latitude and longitude swapped?" : ""));
  if (!(place.longitude_deg >= -180 && place.longitude_deg <= 360))
    location.fail(fmt::format("the longitude {} is not within -180 and 180 degrees", longitude));
  return place;
}

/// Names of the columns in the header; empty if missing.
struct RowNames {
  std::string image;
  std::string time;
};

std::string first_of(const NamedRows& rows, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (rows.has(name)) return name;
  return "";
}

std::optional<Pose> read_pose(const NamedRows& rows, const GpsColumns& columns) {
  const auto place = read_fix(rows, columns);
  if (!place) return std::nullopt;
  Pose pose{earth_position(*place), {}, {}};
  if (!rows.text("heading").empty()) pose.heading_deg = rows.real("heading");
  return pose;
}

/// Times as numbers or dates, all in the unit of the first one.
class TimeColumn {
 public:
  int64_t read(const NamedRows& rows, const std::string& column) {
    const std::string& text = rows.text(column);
    if (const auto date = parse_calendar_time(text)) return *date;
    if (!unit_) unit_ = unit_of_time(text);
    return read_time(rows.location(), text, unit_.value_or(TimeUnit::seconds));
  }

 private:
  std::optional<TimeUnit> unit_;
};

std::map<std::string, size_t> frames_by_name(const std::filesystem::path& images) {
  const SequenceSource sequence = open_sequence(parse_sequence_argument(images.string()));
  if (sequence.kind != SequenceKind::images)
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: is not a folder or list of images, whose names a CSV of GPS fixes can use",
                    images.string()));
  std::map<std::string, size_t> frames;
  for (const auto& file : sequence.files)
    if (!frames.emplace(file.filename().string(), frames.size()).second)
      throw Error(ErrorKind::data, fmt::format("{}: has two images named {}", images.string(),
                                               file.filename().string()));
  return frames;
}

void read_by_name(NamedRows& rows, const GpsColumns& columns, const std::string& name_column,
                  const std::filesystem::path& images, Trajectory& found) {
  const auto frames = frames_by_name(images);
  found.poses.resize(frames.size());
  std::vector<bool> is_named(frames.size());
  for (size_t row = 0; row < rows.size(); ++row) {
    rows.go_to(row);
    const std::string name = std::filesystem::path(rows.text(name_column)).filename().string();
    const auto frame = frames.find(name);
    if (frame == frames.end()) rows.fail(fmt::format("{} has no image {}", images.string(), name));
    if (is_named[frame->second]) rows.fail(fmt::format("the image {} is listed twice", name));
    is_named[frame->second] = true;
    found.poses[frame->second] = read_pose(rows, columns);
  }
}

void read_in_order(NamedRows& rows, const GpsColumns& columns, const std::string& time_column,
                   const FrameRange& range, Trajectory& found) {
  TimeColumn times;
  for (size_t row = 0; row < rows.size(); ++row) {
    rows.go_to(row);
    const auto pose = read_pose(rows, columns);
    if (!frame_in_range(range, row)) continue;
    found.poses.push_back(pose);
    found.lines.push_back(rows.line());
    if (!time_column.empty()) found.times_ns.push_back(times.read(rows, time_column));
  }
}

/// In seconds. Receivers report one fix per second, so a frame is at most half a second from the
/// nearest fix, or one second if a fix is missing.
constexpr double kUsualDifference = 1;

// Throws for other kinds of files, with advice.
void require_gps_csv(const std::filesystem::path& path) {
  const StartedFile opened = open_start(path);
  const FileStart& start = opened.start;
  if (start.is_folder)
    throw Error(ErrorKind::usage, fmt::format("{} is a folder. Write the GPS positions of its "
                                              "images to a CSV with scripts/convert/exif.py",
                                              path.string()));
  if (is_gps(start)) return;
  refuse_unconverted(start.path, start.bytes);
  throw Error(ErrorKind::data,
              fmt::format("{}: is not a CSV with latitudes and longitudes{}", path.string(),
                          is_pose_csv(start) ? "; its positions are in meters" : ""));
}

void check_fixes(const GroundTruthBuilder& builder, const std::filesystem::path& path,
                 const Poses& poses) {
  const auto missing = static_cast<size_t>(
      std::count_if(poses.begin(), poses.end(), [](const auto& pose) { return !pose; }));
  if (missing == poses.size())
    throw Error(ErrorKind::data, fmt::format("{}: has no fix for any frame", path.string()));
  if (missing * 2 > poses.size())
    builder.warn_user(fmt::format("{}: {} of {} have no fix and are ignored", path.string(),
                                  missing, counted(poses.size(), "frame")));
}

Poses read_side(const GroundTruthBuilder& builder, PoseSide side, const FrameCount& count) {
  const GroundTruthOptions& options = builder.argument().options;
  const bool is_query = side == PoseSide::query;
  const std::filesystem::path& path = is_query ? builder.argument().path : options.reference;
  const std::filesystem::path& images = is_query ? options.query_images : options.reference_images;
  std::optional<size_t> frames;
  if (!count.grows) frames = count.frames;
  Poses poses = poses_of_side(builder.argument().options, side, read_fixes(path, images, frames),
                              builder.monitor(), kUsualDifference);
  const bool is_by_time = !(is_query ? options.query_times : options.reference_times).empty();
  if (!is_by_time) check_fixes(builder, path, poses);  // by time, poses_of_side has warned already
  return poses;
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

std::optional<GpsColumns> find_gps_columns(const std::vector<std::string>& header) {
  const GpsColumns columns{find_name(header, {"lat", "latitude"}),
                           find_name(header, {"lon", "lng", "long", "longitude"})};
  if (columns.latitude.empty() || columns.longitude.empty()) return std::nullopt;
  return columns;
}

std::optional<Geographic> read_fix(const NamedRows& rows, const GpsColumns& columns) {
  const std::string& latitude = rows.text(columns.latitude);
  const std::string& longitude = rows.text(columns.longitude);
  if (latitude.empty() && longitude.empty()) return std::nullopt;
  return parse_place(rows.location(), latitude, longitude);
}

bool is_gps(const FileStart& start) {
  return find_gps_columns(header_names(start.first_line)).has_value();
}

Trajectory read_fixes(const std::filesystem::path& path, const std::filesystem::path& images,
                      std::optional<size_t> frames) {
  require_gps_csv(path);
  const SequenceArgument source = parse_sequence_argument(path.string());
  NamedRows rows(source.path, path.string(), {});
  const auto columns = find_gps_columns(rows.header());
  if (!columns) rows.fail("its header has no columns lat and lon");
  if (rows.has("frame")) {
    if (rows.has("x") && rows.has("y"))
      rows.fail("has positions in meters (x, y) and latitudes; remove the columns x and y");
    return read_csv_trajectory(path, frames);
  }
  const RowNames names{first_of(rows, {"image", "name", "file", "filename"}),
                       first_of(rows, {"time", "timestamp"})};
  Trajectory found;
  found.name = path.string();
  found.is_on_earth = true;
  if (!images.empty() && names.image.empty())
    rows.fail("has no column image with the names of images");
  if (images.empty() && !names.image.empty() && names.time.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: has fixes by names of images; pass the images, as in "
                            "--query-images FOLDER (--reference-images for the training side)",
                            path.string()));
  if (!images.empty() && !source.range.is_all())
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: its lines are selected by the names of images; add the range to {}",
                    path.string(), images.string()));
  if (!images.empty())
    read_by_name(rows, *columns, names.image, images, found);
  else
    read_in_order(rows, *columns, names.time, source.range, found);
  return found;
}

std::string read_gps(GroundTruthBuilder& builder) {
  const GroundTruthArgument& argument = builder.argument();
  const size_t sequence = builder.only_searched(argument.path.string());
  if (argument.options.reference.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: has the fixes of the query; pass those of the training sequence, "
                            "as in --ground-truth-reference FIXES",
                            argument.path.string()));
  builder.at_file(argument.path);
  const Poses query = read_side(builder, PoseSide::query, builder.query());
  builder.require_query_frames(query.size());
  builder.at_file(argument.options.reference);
  const Poses train = read_side(builder, PoseSide::train, builder.train(sequence));
  builder.require_train_frames(sequence, train.size());
  return fmt::format("gps positions{}: {}", times_in_words(argument.options, kUsualDifference),
                     match_poses(builder, sequence, query, train));
}

void level(Trajectory& trajectory) {
  if (!trajectory.is_on_earth) return;
  std::optional<LocalPlane> plane;
  for (auto& pose : trajectory.poses) {
    if (!pose) continue;
    if (!plane) plane.emplace(pose->position);
    pose->position = plane->local(pose->position);
  }
  trajectory.is_on_earth = false;
}

}  // namespace vpr
