#include "truth/route.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/monitor.h"
#include "base/text.h"
#include "sequence/sequence_source.h"
#include "truth/gps.h"
#include "truth/text_file.h"

namespace vpr {

namespace fs = std::filesystem;

namespace {

/// The columns of latitudes and longitudes; nullopt for a file with columns x and y.
std::optional<GpsColumns> position_columns(const NamedRows& rows) {
  if (rows.has("x") && rows.has("y")) return std::nullopt;
  auto columns = find_gps_columns(rows.header());
  if (!columns)
    rows.fail(
        fmt::format("its header has no column {} (or lat and lon)", rows.has("x") ? "y" : "x"));
  return columns;
}

// Nullopt if the row has no fix.
std::optional<CsvPose> read_row(const NamedRows& rows, const std::optional<GpsColumns>& gps) {
  CsvPose row;
  if (gps) {
    const auto place = read_fix(rows, *gps);
    if (!place) return std::nullopt;
    row = {{earth_position(*place), {}, {}}, true, {}};
  } else {
    row.pose.position = {rows.real("x"), rows.real("y"), 0};
  }
  if (rows.has("heading")) row.pose.heading_deg = rows.real("heading");
  row.floor = rows.text("floor");
  return row;
}

// The frame of the current row relative to the range; nullopt outside the range.
std::optional<size_t> read_frame(const NamedRows& rows, const FrameRange& range) {
  const auto frame = parse_frame(rows.text("frame"));
  if (!frame || !frame->in_range)
    rows.fail(fmt::format("\"{}\" is not a frame number", rows.text("frame")));
  return frame_in_range(range, frame->value);
}

void require_room(const NamedRows& rows, const PoseCsvRules& rules, const SequenceArgument& source,
                  size_t frame) {
  if (!rules.frames && frame >= rules.most_frames)
    rows.fail("the frame is too large; pass the number of frames");
  if (!rules.frames || frame < *rules.frames) return;
  rows.fail(fmt::format("frame {} is out of range; there are {} frames{}", rows.text("frame"),
                        *rules.frames, source.range.is_all() ? range_hint(source.path) : ""));
}

}  // namespace

Routes read_routes(const std::vector<fs::path>& paths) {
  Routes found;
  std::optional<LocalPlane> plane;
  fs::path meters;  // a file with x and y
  fs::path gps;     // a file with latitudes
  for (const fs::path& path : paths) {
    Route& route = found.routes.emplace_back();
    if (path.empty()) continue;
    for (const auto& row : read_pose_csv(path, {})) {
      route.emplace_back();
      if (!row) continue;
      (row->is_on_earth ? gps : meters) = path;
      if (!meters.empty() && !gps.empty())
        throw Error(ErrorKind::data, fmt::format("{} has latitudes and longitudes, but {} has x "
                                                 "and y in meters; use one of them for both",
                                                 gps.string(), meters.string()));
      std::array<double, 3> position = row->pose.position;
      if (row->is_on_earth) {
        if (!plane) plane.emplace(position);
        position = plane->local(position);
      }
      route.back() = {position[0], position[1], row->floor};
    }
  }
  found.is_gps = plane.has_value();
  return found;
}

std::vector<RoutePoint> read_place_positions(const fs::path& path) {
  NamedRows rows(path, path.string(), {"place", "x", "y"});
  std::vector<RoutePoint> places;
  std::set<std::string> seen;
  for (size_t row = 0; row < rows.size(); ++row) {
    rows.go_to(row);
    if (seen.insert(rows.text("place")).second)
      places.push_back({rows.real("x"), rows.real("y"), rows.text("floor")});
  }
  return places;
}

std::vector<WallLine> read_walls(const fs::path& path) {
  NamedRows rows(path, path.string(), {"x0", "y0", "x1", "y1"});
  std::vector<WallLine> walls;
  for (size_t row = 0; row < rows.size(); ++row) {
    rows.go_to(row);
    const std::string floor = rows.text("floor");
    walls.push_back(
        {{rows.real("x0"), rows.real("y0"), floor}, {rows.real("x1"), rows.real("y1"), floor}});
  }
  return walls;
}

std::vector<double> read_traveled(const std::filesystem::path& path, const Sequence& sequence,
                                  const Monitor& monitor) {
  const size_t frames = sequence.frames;
  const std::vector<std::optional<CsvPose>> poses =
      selected(read_pose_csv(path, {sequence.recorded_frames()}), sequence.selection);
  const auto known = [](const auto& pose) { return pose.has_value(); };
  const auto missing = std::find_if_not(poses.begin(), poses.end(), known);
  if (missing != poses.end()) {
    warn(monitor,
         fmt::format("{}: has no pose for {} of {} (the first is frame {}), so there are no "
                     "distances in meters",
                     path.string(),
                     frames - static_cast<size_t>(std::count_if(poses.begin(), poses.end(), known)),
                     counted(frames, "frame"), missing - poses.begin()));
    return {};
  }
  std::vector<double> traveled_m;
  for (size_t frame = 0; frame < frames; ++frame) {
    double square = 0;
    for (size_t k = 0; frame > 0 && k < 3; ++k) {
      const double step = poses[frame]->pose.position[k] - poses[frame - 1]->pose.position[k];
      square += step * step;
    }
    // Correctly rounded on every machine, unlike hypot.
    traveled_m.push_back(frame == 0 ? 0 : traveled_m.back() + std::sqrt(square));
  }
  if (!traveled_m.empty() && !std::isfinite(traveled_m.back()))
    throw Error(ErrorKind::data,
                fmt::format("{}: its positions are too far apart for meters", path.string()));
  return traveled_m;
}

std::vector<std::optional<CsvPose>> read_pose_csv(const std::filesystem::path& path,
                                                  const PoseCsvRules& rules) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  NamedRows rows(source.path, path.string(), {"frame"});
  const auto gps = position_columns(rows);
  const auto in_range = frame_count(source.range);
  if (in_range && rules.frames && *in_range != *rules.frames)
    rows.fail(fmt::format("its range has {}, but the sequence has {}", counted(*in_range, "frame"),
                          *rules.frames));
  std::vector<std::optional<CsvPose>> poses(rules.frames.value_or(0));
  for (size_t row = 0; row < rows.size(); ++row) {
    rows.go_to(row);
    const auto frame = read_frame(rows, source.range);
    if (!frame) continue;
    require_room(rows, rules, source, *frame);
    if (*frame >= poses.size()) poses.resize(*frame + 1);
    if (poses[*frame]) rows.fail(fmt::format("frame {} is listed twice", rows.text("frame")));
    poses[*frame] = read_row(rows, gps);
  }
  return poses;
}

}  // namespace vpr
