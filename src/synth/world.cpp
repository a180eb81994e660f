#include "synth/world.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "synth/progress.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kNameLetters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
constexpr double kMaxMeters = 500;     // maximum of a coordinate
constexpr double kMaxPlanM2 = 20'000;  // painted at 64 x 64 texels per square meter
constexpr size_t kMaxLetters = 100;
constexpr uint64_t kMaxFrames = 100'000;

// Checks values; its messages name the world.
class Checker {
 public:
  explicit Checker(std::string where) : where_(std::move(where)) {}

  void require(bool ok, std::string_view what) const {
    if (!ok) throw Error(ErrorKind::usage, fmt::format("{}: {}", where_, what));
  }
  void in_range(double value, double low, double high, std::string_view name) const {
    require(value >= low && value <= high, fmt::format("{} must be {} to {}", name, low, high));
  }
  void on_grid(double value, std::string_view name) const {
    in_range(value, -kMaxMeters, kMaxMeters, name);
    require(std::abs(std::remainder(value, kPlanCellM)) < 1e-9,
            fmt::format("{} must be a multiple of {} m", name, kPlanCellM));
  }
  void names(std::set<std::string>& seen, const std::string& name, std::string_view what) const {
    require(!name.empty() && name.find_first_not_of(kNameLetters) == std::string::npos,
            fmt::format("the name of a {} must be of letters, digits, - and _", what));
    require(name.size() <= kMaxLetters,
            fmt::format("the name of a {} must have at most {} letters", what, kMaxLetters));
    require(seen.insert(name).second, fmt::format("the name {} is used twice", name));
  }

 private:
  std::string where_;
};

void check_extent(const Floor& floor, const Checker& check) {
  double left = kMaxMeters, bottom = kMaxMeters, right = -kMaxMeters, top = -kMaxMeters;
  for (const Room& room : floor.rooms) {
    left = std::min(left, room.x);
    bottom = std::min(bottom, room.y);
    right = std::max(right, room.x + room.width);
    top = std::max(top, room.y + room.depth);
  }
  check.require((right - left) * (top - bottom) <= kMaxPlanM2 && right - left <= kMaxMeters &&
                    top - bottom <= kMaxMeters,
                fmt::format("the floor {} is {} m x {} m; the maximum is {} square meters",
                            floor.name, right - left, top - bottom, kMaxPlanM2));
}

void check_floor(const World& world, size_t index, const Checker& check) {
  const Floor& floor = world.floors[index];
  check.in_range(floor.resemblance, 0, 1, "the resemblance of a floor");
  if (!floor.like.empty()) {
    const auto end = world.floors.begin() + static_cast<std::ptrdiff_t>(index);
    const auto twin = std::find_if(world.floors.begin(), end,
                                   [&](const Floor& other) { return other.name == floor.like; });
    check.require(twin != end && twin->like.empty(),
                  fmt::format("the floor {} is like {}, which is not an earlier floor with rooms",
                              floor.name, floor.like));
    check.require(floor.rooms.empty() && floor.pillars.empty() && floor.glass.empty(),
                  fmt::format("the floor {} is like {}: it must not have its own rooms", floor.name,
                              floor.like));
    return;
  }
  check.require(!floor.rooms.empty(), fmt::format("the floor {} has no rooms", floor.name));
  for (const Room& room : floor.rooms) {
    check.on_grid(room.x, "x of a room");
    check.on_grid(room.y, "y of a room");
    check.on_grid(room.width, "width of a room");
    check.on_grid(room.depth, "depth of a room");
    check.require(room.width > 0 && room.depth > 0, "a room must be wider and deeper than 0");
    check.require(room.lamp_spacing_m == 0 ||
                      (room.lamp_spacing_m >= 0.5 && room.lamp_spacing_m <= kMaxMeters),
                  "lamp_spacing_m of a room must be 0, or 0.5 to 500");
  }
  check_extent(floor, check);
  const auto in_rooms = [&](double x, double y) {
    return std::any_of(floor.rooms.begin(), floor.rooms.end(), [&](const Room& room) {
      return x >= room.x && y >= room.y && x < room.x + room.width && y < room.y + room.depth;
    });
  };
  for (const Pillar& pillar : floor.pillars) {
    check.on_grid(pillar.x, "x of a pillar");
    check.on_grid(pillar.y, "y of a pillar");
    check.require(in_rooms(pillar.x, pillar.y), "a pillar is outside all rooms");
  }
  for (const GlassFront& glass : floor.glass)
    for (const double value : {glass.from_x, glass.from_y, glass.to_x, glass.to_y})
      check.in_range(value, -kMaxMeters, kMaxMeters, "a coordinate of a glass front");
}

// Whether a walk reaches its stops and cuts is checked when it is simulated.
void check_progress(const Walk& walk, const Checker& check) {
  constexpr double kMaxWayM = 100'000;
  constexpr double kMaxStopS = 3600;
  const auto way = [&](double value, std::string_view name) {
    check.in_range(value, 0, kMaxWayM, name);
  };
  for (size_t i = 0; i < walk.paces.size(); ++i) {
    way(walk.paces[i].from_m, "from_m of a pace");
    check.in_range(walk.paces[i].speed_m_s, 0.05, 100, "speed_m_s of a pace");
    check.require(
        i == 0 || walk.paces[i].from_m > walk.paces[i - 1].from_m,
        fmt::format("the paces of the walk {} must be in the order of from_m", walk.name));
  }
  for (const WalkStop& stop : walk.stops) {
    way(stop.at_m, "at_m of a stop");
    check.in_range(stop.seconds, 0, kMaxStopS, "seconds of a stop");
  }
  for (const WalkCut& cut : walk.cuts) {
    way(cut.at_m, "at_m of a cut");
    way(cut.to_m, "to_m of a cut");
  }
  check.require(
      walk.frames == 0 || !is_uneven(walk),
      fmt::format("the paces, stops and cuts of the walk {} determine its number of frames; "
                  "remove frames",
                  walk.name));
}

void check_walk(const World& world, const Walk& walk, const Checker& check) {
  floor_index(world, walk.floor);
  check.require(!walk.path.empty(), fmt::format("the walk {} has no path", walk.name));
  for (const auto& corner : walk.path) {
    check.require(corner.size() == 2, "a corner of a path must be [x, y]");
    for (const double value : corner) check.in_range(value, -kMaxMeters, kMaxMeters, "a corner");
  }
  check.require(walk.frames <= kMaxFrames, fmt::format("frames must be at most {}", kMaxFrames));
  check.in_range(walk.speed_m_s, 0.05, 100, "speed_m_s");
  check_progress(walk, check);
  check.in_range(walk.unevenness, 0, 0.8, "unevenness");
  check.in_range(walk.shake, 0, 10, "shake");
  check.in_range(walk.tremor_deg, 0, 5, "tremor_deg");
  check.in_range(walk.jolt_deg, 0, 5, "jolt_deg");
  for (const uint64_t groups : {walk.passers_by, walk.standing, walk.crossing, walk.ahead})
    check.require(groups <= 1000, "passers_by, standing, crossing and ahead must be at most 1000");
  check.in_range(walk.conditions.lamps, 0, 10, "lamps");
  check.in_range(walk.conditions.daylight, 0, 10, "daylight");
  check.in_range(walk.conditions.warmth, -1, 1, "warmth");
  check.in_range(walk.conditions.exposure, 0.01, 100, "exposure");
  check.in_range(walk.conditions.noise, 0, 100, "noise");
  check.in_range(walk.conditions.shutter_s, 0, 1, "shutter_s");
  check.in_range(walk.conditions.exposure_lag_s, 0, 5, "exposure_lag_s");
}

void check_variety(const BuildingVariety& variety, const Checker& check) {
  check.in_range(variety.finishes, 0, 1, "finishes");
  check.in_range(variety.bareness, 0, 1, "bareness");
  check.in_range(variety.wear, 0, 1, "wear");
  check.in_range(variety.window_light, 0, 10, "window_light");
  check.in_range(variety.far_view, 0, 1, "far_view");
  check.in_range(variety.reflections, 0, 1, "reflections");
  check.in_range(variety.changes, 0, 1, "changes");
  check.in_range(variety.hands, 0, 3, "hands");
}

void check_world(const World& world, const Checker& check) {
  check.in_range(world.fps, 0.1, 1000, "fps");
  check.in_range(static_cast<double>(world.image_width), 32, 4096, "image_width");
  check.in_range(static_cast<double>(world.image_height), 32, 4096, "image_height");
  check.in_range(world.view_deg, 20, 120, "view_deg");
  check.in_range(world.resemblance, 0, 1, "resemblance");
  check_variety(world.variety, check);
  check.in_range(world.same_place_m, 0, kMaxMeters, "same_place_m");
  check.in_range(world.same_heading_deg, 0, 180, "same_heading_deg");
  check.in_range(world.ignore_m, 0, kMaxMeters, "ignore_m");
  check.in_range(world.place_radius_m, 0, kMaxMeters, "place_radius_m");
  check.in_range(world.place_ignore_m, 0, kMaxMeters, "place_ignore_m");
  check.require(!world.walks.empty(), "walks must not be empty");
  std::set<std::string> names;
  for (size_t i = 0; i < world.floors.size(); ++i) {
    check.names(names, world.floors[i].name, "floor");
    check_floor(world, i, check);
  }
  names = {"places"};  // the folder of their views
  for (const Walk& walk : world.walks) {
    check.names(names, walk.name, "walk");
    check_walk(world, walk, check);
  }
  names.clear();
  for (const WorldPlace& place : world.places) {
    check.names(names, place.name, "place");
    floor_index(world, place.floor);
    check.require(!place.headings.empty(), fmt::format("the place {} has no headings", place.name));
    for (const double value : {place.x, place.y})
      check.in_range(value, -kMaxMeters, kMaxMeters, "a coordinate of a place");
    for (const double heading : place.headings) check.in_range(heading, -360, 360, "a heading");
  }
}

}  // namespace

World read_world(const fs::path& path) {
  const std::string where = path.string();
  Json json = read_json(path, ErrorKind::usage);
  require_schema(json, "world", where, ErrorKind::usage);
  json.erase("schema");
  World world;
  value_from_json(json, world, where, "world");
  check_world(world, Checker(where));
  return world;
}

size_t floor_index(const World& world, const std::string& name) {
  for (size_t i = 0; i < world.floors.size(); ++i)
    if (world.floors[i].name == name) return i;
  throw Error(ErrorKind::usage, fmt::format("the world {} has no floor {}", world.name, name));
}

const Floor& plan_floor(const World& world, size_t floor) {
  const Floor& own = world.floors[floor];
  return own.like.empty() ? own : world.floors[floor_index(world, own.like)];
}

}  // namespace vpr
