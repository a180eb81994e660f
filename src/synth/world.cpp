#include "synth/world.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kNameLetters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
constexpr double kMaxMeters = 500;     // maximum of a coordinate
constexpr double kMaxPlanM2 = 20'000;  // painted at 64 x 64 texels per square meter
constexpr size_t kMaxLetters = 100;

// Checks values; its messages name the world.
class Checker {
 public:
  explicit Checker(std::string where) : where_(std::move(where)) {}

  void require(bool ok, std::string_view what) const {
    if (!ok) throw Error(ErrorKind::usage, "{}: {}", where_, what);
  }
  /// Checks the bounds of all numbers in a value and its fields.
  template <class T>
  void bounds(T& value, std::string_view key, const auto&... hints) const {
    if constexpr (Settings<T>)
      visit_fields(value, [&](std::string_view name, auto& field, std::string_view,
                              const auto&... more) { bounds(field, name, more...); });
    else if constexpr (detail::kIsList<T>)
      for (auto& item : value) bounds(item, key, hints...);
    else if constexpr (std::is_arithmetic_v<T>)
      (check_bounds(value, key, hints), ...);
  }
  void on_grid(std::initializer_list<double> meters, std::string_view what) const {
    for (const double value : meters)
      require(std::abs(std::remainder(value, kPlanCellM)) < 1e-9,
              fmt::format("the coordinates of a {} must be multiples of {} m", what, kPlanCellM));
  }
  void names(std::set<std::string>& seen, const std::string& name, std::string_view what) const {
    require(!name.empty() && name.find_first_not_of(kNameLetters) == std::string::npos,
            fmt::format("the name of a {} must be of letters, digits, - and _", what));
    require(name.size() <= kMaxLetters,
            fmt::format("the name of a {} must have at most {} letters", what, kMaxLetters));
    require(seen.insert(name).second, fmt::format("the name {} is used twice", name));
  }

 private:
  void check_bounds(auto value, std::string_view key, const Bounds& bounds) const {
    const auto number = static_cast<double>(value);
    require(number >= bounds.least && number <= bounds.most,
            fmt::format("{} must be {} to {}, found {}", key, bounds.least, bounds.most, value));
  }
  void check_bounds(auto, std::string_view, const auto&) const {}

  std::string where_;
};

void check_extent(const Floor& floor, const Checker& check) {
  const auto [left, bottom, right, top] = extent_of(floor);
  check.require((right - left) * (top - bottom) <= kMaxPlanM2 && right - left <= kMaxMeters &&
                    top - bottom <= kMaxMeters,
                fmt::format("the floor {} is {} m x {} m; the maximum is {} square meters",
                            floor.name, right - left, top - bottom, kMaxPlanM2));
}

void check_floor(const World& world, size_t index, const Checker& check) {
  const Floor& floor = world.floors[index];
  if (!floor.like.empty()) {
    const auto end = world.floors.begin() + static_cast<std::ptrdiff_t>(index);
    const auto twin = std::ranges::find(world.floors.begin(), end, floor.like, &Floor::name);
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
    check.on_grid({room.x, room.y, room.width, room.depth}, "room");
    check.require(room.lamp_spacing_m == 0 ||
                      (room.lamp_spacing_m >= 0.5 && room.lamp_spacing_m <= kMaxMeters),
                  "lamp_spacing_m of a room must be 0, or 0.5 to 500");
  }
  check_extent(floor, check);
  for (const Pillar& pillar : floor.pillars) {
    check.on_grid({pillar.x, pillar.y}, "pillar");
    const auto has_pillar = [&](const Room& room) { return room.contains(pillar.x, pillar.y); };
    check.require(std::ranges::any_of(floor.rooms, has_pillar), "a pillar is outside all rooms");
  }
}

// Whether a walk reaches its stops and cuts is checked when it is simulated.
void check_walk(const World& world, const Walk& walk, const Checker& check) {
  floor_index(world, walk.floor);
  check.require(!walk.path.empty(), fmt::format("the walk {} has no path", walk.name));
  for (const auto& corner : walk.path)
    check.require(corner.size() == 2, "a corner of a path must be [x, y]");
  check.require(std::ranges::adjacent_find(walk.paces, std::greater_equal<>(), &WalkPace::from_m) ==
                    walk.paces.end(),
                fmt::format("the paces of the walk {} must be in the order of from_m", walk.name));
  check.require(
      walk.frames == 0 || !is_uneven(walk),
      fmt::format("the paces, stops and cuts of the walk {} determine its number of frames; "
                  "remove frames",
                  walk.name));
}

void check_world(World& world, const Checker& check) {
  check.bounds(world, "");
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

bool is_uneven(const Walk& walk) {
  return !walk.paces.empty() || !walk.stops.empty() || !walk.cuts.empty();
}

FloorExtent extent_of(const Floor& floor) {
  constexpr double kFar = std::numeric_limits<double>::max();
  FloorExtent extent{kFar, kFar, -kFar, -kFar};
  for (const Room& room : floor.rooms) {
    extent.left = std::min(extent.left, room.x);
    extent.bottom = std::min(extent.bottom, room.y);
    extent.right = std::max(extent.right, room.x + room.width);
    extent.top = std::max(extent.top, room.y + room.depth);
  }
  return extent;
}

size_t floor_index(const World& world, const std::string& name) {
  for (size_t i = 0; i < world.floors.size(); ++i)
    if (world.floors[i].name == name) return i;
  throw Error(ErrorKind::usage, "the world {} has no floor {}", world.name, name);
}

const Floor& plan_floor(const World& world, size_t floor) {
  const Floor& own = world.floors[floor];
  return own.like.empty() ? own : world.floors[floor_index(world, own.like)];
}

}  // namespace vpr
