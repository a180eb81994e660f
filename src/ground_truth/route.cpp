#include "ground_truth/route.h"

#include <set>

#include <fmt/format.h>

#include "base/error.h"
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

}  // namespace vpr
