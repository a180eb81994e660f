#include "ground_truth/gps_csv.h"

#include <initializer_list>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "ground_truth/calendar_time.h"
#include "ground_truth/frame_times.h"
#include "ground_truth/geodesy.h"
#include "ground_truth/gps_columns.h"
#include "ground_truth/named_rows.h"
#include "images/sequence.h"

namespace vpr {
namespace {

/// Of the columns of a header; empty where there is none.
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

/// A time as a number or a date, in the unit of the first.
class TimeColumn {
 public:
  int64_t read(const NamedRows& rows, const std::string& column) {
    const std::string& text = rows.text(column);
    if (const auto date = parse_calendar_time(text)) return date->ns;
    if (!unit_) unit_ = unit_of_time(text);
    return read_time(rows.location(), text, unit_.value_or(TimeUnit::seconds));
  }

 private:
  std::optional<TimeUnit> unit_;
};

std::map<std::string, size_t> frames_by_name(const std::filesystem::path& images) {
  const Sequence sequence = open_sequence(parse_sequence_argument(images.string()));
  if (sequence.kind != SequenceKind::images)
    throw Error(ErrorKind::usage,
                fmt::format("{}: is no folder or list of images, whose names a CSV of GPS fixes "
                            "could have",
                            images.string()));
  std::map<std::string, size_t> frames;
  for (const auto& file : sequence.files)
    if (!frames.emplace(file.filename().string(), frames.size()).second)
      throw Error(ErrorKind::data, fmt::format("{}: has two images called {}", images.string(),
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
    if (is_named[frame->second]) rows.fail(fmt::format("the image {} is given twice", name));
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

}  // namespace

Trajectory read_gps_csv(const std::filesystem::path& path, const std::filesystem::path& images,
                        std::optional<size_t> frames) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  NamedRows rows(source.path, path.string(), {});
  const auto columns = find_gps_columns(rows.header());
  if (!columns) rows.fail("its header has no columns lat and lon");
  if (rows.has("frame")) {
    if (rows.has("x") && rows.has("y"))
      rows.fail("has positions in metres (x, y) beside latitudes; leave out the columns x and y");
    return read_csv_trajectory(path, frames);
  }
  const RowNames names{first_of(rows, {"image", "name", "file", "filename"}),
                       first_of(rows, {"time", "timestamp"})};
  Trajectory found;
  found.name = path.string();
  found.is_on_earth = true;
  if (!images.empty() && names.image.empty())
    rows.fail("has no column image, whose names could be those of images");
  if (images.empty() && !names.image.empty() && names.time.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: has fixes by names of images; say of which, as in "
                            "--query-images FOLDER (--reference-images for the training side)",
                            path.string()));
  if (!images.empty() && !source.range.is_all())
    throw Error(ErrorKind::usage,
                fmt::format("{}: its lines are found by the names of images; give "
                            "the range to {}",
                            path.string(), images.string()));
  if (!images.empty())
    read_by_name(rows, *columns, names.image, images, found);
  else
    read_in_order(rows, *columns, names.time, source.range, found);
  return found;
}

}  // namespace vpr
