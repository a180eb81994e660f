#include "ground_truth/route.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/monitor.h"
#include "base/text.h"
#include "ground_truth/gps.h"
#include "ground_truth/named_rows.h"
#include "ground_truth/pose_csv.h"

namespace vpr {

namespace fs = std::filesystem;

namespace {

/// What the files read so far are in.
struct MapPlane {
  fs::path metres;  ///< a file that has x and y
  fs::path gps;     ///< a file that has latitudes
  std::optional<LocalPlane> plane;
};

void require_one_kind(const MapPlane& map) {
  if (map.metres.empty() || map.gps.empty()) return;
  throw Error(ErrorKind::data,
              fmt::format("{} has latitudes and longitudes, and {} x and y in metres: give both in "
                          "one way",
                          map.gps.string(), map.metres.string()));
}

RoutePoint on_plane(MapPlane& map, const fs::path& path, const CsvPose& pose) {
  (pose.place ? map.gps : map.metres) = path;
  require_one_kind(map);
  std::array<double, 3> position = pose.position;
  if (pose.place) {
    if (!map.plane) map.plane.emplace(position);
    position = map.plane->local(position);
  }
  return {position[0], position[1], pose.floor};
}

}  // namespace

Routes read_routes(const std::vector<fs::path>& paths) {
  Routes found;
  MapPlane map;
  for (const fs::path& path : paths) {
    Route& route = found.routes.emplace_back();
    if (path.empty()) continue;
    for (const auto& pose : read_pose_csv(path, {})) {
      route.emplace_back();
      if (pose) route.back() = on_plane(map, path, *pose);
    }
  }
  found.is_gps = map.plane.has_value();
  return found;
}

Route read_route(const fs::path& path) { return std::move(read_routes({path}).routes.front()); }

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

std::vector<double> read_travelled(const std::filesystem::path& path, size_t frames,
                                   const Monitor& monitor, const std::optional<Replay>& replay) {
  const std::vector<std::optional<CsvPose>> poses =
      replay ? replayed(read_pose_csv(path, {replay->recorded_frames}), *replay)
             : read_pose_csv(path, {frames});
  const auto known = [](const auto& pose) { return pose.has_value(); };
  const auto missing = std::find_if_not(poses.begin(), poses.end(), known);
  if (missing != poses.end()) {
    warn(monitor,
         fmt::format("{}: has no pose of {} of {} (the first is frame {}), so "
                     "nothing is given in metres",
                     path.string(),
                     frames - static_cast<size_t>(std::count_if(poses.begin(), poses.end(), known)),
                     counted(frames, "frame"), missing - poses.begin()));
    return {};
  }
  std::vector<double> travelled_m;
  for (size_t frame = 0; frame < frames; ++frame) {
    if (frame == 0) {
      travelled_m.push_back(0);
      continue;
    }
    double square = 0;
    for (size_t k = 0; k < 3; ++k) {
      const double step = poses[frame]->position[k] - poses[frame - 1]->position[k];
      square += step * step;
    }
    // Rounded correctly everywhere, which hypot is not.
    travelled_m.push_back(travelled_m.back() + std::sqrt(square));
  }
  if (!travelled_m.empty() && !std::isfinite(travelled_m.back()))
    throw Error(ErrorKind::data,
                fmt::format("{}: its positions are too far apart for metres", path.string()));
  return travelled_m;
}

}  // namespace vpr
