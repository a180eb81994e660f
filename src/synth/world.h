// What vpr-synth renders: buildings as floor plans, and walks through them (vpr.world/1).
//
// Metres. x goes right and y up on the plan; headings are in degrees, anticlockwise from x.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "synth/building_variety.h"
#include "synth/walk_settings.h"

namespace vpr {

/// Halls are wider, brighter and furnished otherwise than corridors.
enum class RoomKind { corridor, hall };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<RoomKind> = {"corridor", "hall"};

/// A rectangle that one can walk in. Where rooms touch or overlap there is no wall between them.
struct Room {
  RoomKind kind = RoomKind::corridor;
  double x = 0;               ///< left, a multiple of kPlanCellM like the next three
  double y = 0;               ///< bottom
  double width = 0;           ///< to the right
  double depth = 0;           ///< upwards
  double lamp_spacing_m = 0;  ///< about as far apart are its lamps; 0: 3 m, in halls 4 m
};

template <class Visitor>
void visit_fields(Room& room, Visitor&& visit) {
  visit("kind", room.kind);
  visit("x", room.x);
  visit("y", room.y);
  visit("width", room.width);
  visit("depth", room.depth);
  visit("lamp_spacing_m", room.lamp_spacing_m);
}

/// A square pillar of kPlanCellM, by its lower left corner.
struct Pillar {
  double x = 0;
  double y = 0;
};

template <class Visitor>
void visit_fields(Pillar& pillar, Visitor&& visit) {
  visit("x", pillar.x);
  visit("y", pillar.y);
}

/// Walls along this line are glass fronts with daylight behind them.
struct GlassFront {
  double from_x = 0;
  double from_y = 0;
  double to_x = 0;
  double to_y = 0;
};

template <class Visitor>
void visit_fields(GlassFront& glass, Visitor&& visit) {
  visit("from_x", glass.from_x);
  visit("from_y", glass.from_y);
  visit("to_x", glass.to_x);
  visit("to_y", glass.to_y);
}

/// One floor of a building. With `like`, its plan is another floor's, and so is as much of its
/// furnishing as `resemblance` says.
struct Floor {
  std::string name;
  std::string like;
  double resemblance = 0.8;  ///< with `like`: share of things that stand at the same place there
  std::vector<Room> rooms;
  std::vector<Pillar> pillars;
  std::vector<GlassFront> glass;
};

template <class Visitor>
void visit_fields(Floor& floor, Visitor&& visit) {
  visit("name", floor.name);
  visit("like", floor.like);
  visit("resemblance", floor.resemblance);
  visit("rooms", floor.rooms);
  visit("pillars", floor.pillars);
  visit("glass", floor.glass);
}

/// A place of FAB-MAP: one view in each heading.
struct WorldPlace {
  std::string name;
  std::string floor;
  double x = 0;
  double y = 0;
  std::vector<double> headings;
};

template <class Visitor>
void visit_fields(WorldPlace& place, Visitor&& visit) {
  visit("name", place.name);
  visit("floor", place.floor);
  visit("x", place.x);
  visit("y", place.y);
  visit("headings", place.headings);
}

/// The files that frames become.
enum class FrameFormat { jpg, png };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<FrameFormat> = {"jpg", "png"};

/// All that a recording is rendered from.
struct World {
  std::string name;
  uint64_t seed = 1;
  double fps = 8;
  uint64_t image_width = 640;
  uint64_t image_height = 480;
  double view_deg = 66;  ///< horizontal angle of view
  FrameFormat format = FrameFormat::jpg;
  double resemblance = 0.5;      ///< share of things that stand alike in all corridors
  BuildingVariety variety;       ///< what makes parts of a building, days and walks differ
  double same_place_m = 1.5;     ///< frames at most so far apart show the same place, ...
  double same_heading_deg = 40;  ///< ... if they look the same way
  double ignore_m = 3;           ///< up to here they count as neither the same nor different
  double place_radius_m = 2.5;   ///< a frame so near to a place, looking as a view does, shows it
  double place_ignore_m = 5;     ///< up to here it counts as neither showing it nor not
  std::vector<Floor> floors;
  std::vector<WorldPlace> places;
  std::vector<Walk> walks;
};

template <class Visitor>
void visit_fields(World& world, Visitor&& visit) {
  visit("name", world.name);
  visit("seed", world.seed);
  visit("fps", world.fps);
  visit("image_width", world.image_width);
  visit("image_height", world.image_height);
  visit("view_deg", world.view_deg);
  visit("format", world.format);
  visit("resemblance", world.resemblance);
  visit("variety", world.variety);
  visit("same_place_m", world.same_place_m);
  visit("same_heading_deg", world.same_heading_deg);
  visit("ignore_m", world.ignore_m);
  visit("place_radius_m", world.place_radius_m);
  visit("place_ignore_m", world.place_ignore_m);
  visit("floors", world.floors);
  visit("places", world.places);
  visit("walks", world.walks);
}

/// The grid of floor plans, in metres.
inline constexpr double kPlanCellM = 0.5;
/// From floor to ceiling, in metres.
inline constexpr double kRoomHeightM = 2.9;
inline constexpr double kEyeHeightM = 1.45;  ///< of the phone

/// Reads a world. Throws Error(input) if it can't be read, Error(usage) if it is no world or a
/// value is out of range.
World read_world(const std::filesystem::path& path);

/// The index of a floor; it exists in a world that was read.
size_t floor_index(const World& world, const std::string& name);

/// The floor whose plan this one has: itself, or the one it is like.
const Floor& plan_floor(const World& world, size_t floor);

}  // namespace vpr
