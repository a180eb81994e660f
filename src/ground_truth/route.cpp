#include "ground_truth/route.h"

#include <set>

#include "ground_truth/named_rows.h"
#include "ground_truth/pose_csv.h"

namespace vpr {

namespace fs = std::filesystem;

std::vector<std::optional<RoutePoint>> read_route(const fs::path& path) {
  std::vector<std::optional<RoutePoint>> route;
  for (const auto& pose : read_pose_csv(path, {})) {
    route.emplace_back();
    if (pose) route.back() = RoutePoint{pose->x, pose->y, pose->floor};
  }
  return route;
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

}  // namespace vpr
