// What vpr-synth renders: buildings as floor plans, and walks through them (vpr.world/1).
//
// Metres. x goes right and y up on the plan; headings are in degrees, anticlockwise from x.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"

namespace vpr {

/// What makes the parts of a building differ, and one day or walk from another. Each setting is off
/// at 0, and then nothing that is drawn by chance changes.
struct BuildingVariety {
  double finishes = 0;      ///< 0 to 1: paint, flooring, ceiling and lamps differ between rooms
  double bareness = 0;      ///< 0 to 1: share of walls with nothing but doors, windows and fittings
  double wear = 0;          ///< 0 to 1: stains, scuffs, faded and mended paint
  double window_light = 0;  ///< 0 to 10: daylight that falls in through windows and glass fronts
  double far_view = 0;      ///< 0 to 1: how much of what is outside is far away, beyond parallax
  double reflections = 0;   ///< 0 to 1: share of light that glass reflects
  double changes = 0;       ///< 0 to 1: share of places at walls that are otherwise on another day
  double hands = 0;         ///< 0 to 3: how differently a phone is held from walk to walk
};

template <class Visitor>
void visit_fields(BuildingVariety& variety, Visitor&& visit) {
  visit("finishes", variety.finishes);
  visit("bareness", variety.bareness);
  visit("wear", variety.wear);
  visit("window_light", variety.window_light);
  visit("far_view", variety.far_view);
  visit("reflections", variety.reflections);
  visit("changes", variety.changes);
  visit("hands", variety.hands);
}

/// What frames of a walk are for.
enum class WalkUse { train, query, pretrain };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<WalkUse> = {"train", "query",
                                                                        "pretrain"};

/// Light, and how well the camera does.
struct Conditions {
  double lamps = 1;           ///< artificial light; 1: all lamps on
  double daylight = 1;        ///< 0: night, 1: noon
  double warmth = 0;          ///< white balance, -1 (blue) to 1 (yellow)
  double exposure = 1;        ///< factor on what the automatic exposure chooses
  double noise = 3;           ///< sensor noise, standard deviation in grey values
  double shutter_s = 0;       ///< blurs all turns for so long; 0: turns sideways alone, for 1/50 s
  double exposure_lag_s = 0;  ///< the automatic exposure follows what was seen so long before
};

template <class Visitor>
void visit_fields(Conditions& conditions, Visitor&& visit) {
  visit("lamps", conditions.lamps);
  visit("daylight", conditions.daylight);
  visit("warmth", conditions.warmth);
  visit("exposure", conditions.exposure);
  visit("noise", conditions.noise);
  visit("shutter_s", conditions.shutter_s);
  visit("exposure_lag_s", conditions.exposure_lag_s);
}

/// From this point of the path on, the walk has this speed, until the next one.
struct WalkPace {
  double from_m = 0;  ///< along the path, as it is walked
  double speed_m_s = 1.2;
};

template <class Visitor>
void visit_fields(WalkPace& pace, Visitor&& visit) {
  visit("from_m", pace.from_m);
  visit("speed_m_s", pace.speed_m_s);
}

/// Where the walker stands for a while.
struct WalkStop {
  double at_m = 0;  ///< along the path
  double seconds = 5;
};

template <class Visitor>
void visit_fields(WalkStop& stop, Visitor&& visit) {
  visit("at_m", stop.at_m);
  visit("seconds", stop.seconds);
}

/// Where the recording is cut and goes on elsewhere: further on, or back.
struct WalkCut {
  double at_m = 0;  ///< along the path; 0: the walk begins at to_m
  double to_m = 0;
};

template <class Visitor>
void visit_fields(WalkCut& cut, Visitor&& visit) {
  visit("at_m", cut.at_m);
  visit("to_m", cut.to_m);
}

/// A path that somebody walks along with a phone.
struct Walk {
  std::string name;
  WalkUse use = WalkUse::train;
  std::string floor;
  std::vector<std::vector<double>> path;  ///< corners [x, y]; the walk rounds them
  uint64_t frames = 0;                    ///< 0: as many as the speed gives
  double speed_m_s = 1.2;                 ///< mean; follows from `frames` where that is given
  std::vector<WalkPace> paces;            ///< by from_m; in front of the first, speed_m_s
  std::vector<WalkStop> stops;            ///< in the order in which they are met, as are
  std::vector<WalkCut> cuts;              ///< cuts; with any of the three, `frames` is 0
  double unevenness = 0.15;               ///< most that the speed varies by, as a share of it
  double shake = 1;                       ///< factor on the sway and turns of a hand-held phone
  double tremor_deg = 0;                  ///< how far the hand trembles, several times a second
  double jolt_deg = 0;                    ///< how far each step jolts the camera, for a moment
  uint64_t passers_by = 0;                ///< groups of one to three people that walk by
  uint64_t standing = 0;                  ///< groups of one to four that stand at the walls
  uint64_t crossing = 0;                  ///< groups that cross the way in front of the camera
  uint64_t ahead = 0;                     ///< groups that walk ahead of it for a while
  uint64_t day = 0;                       ///< walks of one day find things as they are that day
  Conditions conditions;
};

template <class Visitor>
void visit_fields(Walk& walk, Visitor&& visit) {
  visit("name", walk.name);
  visit("use", walk.use);
  visit("floor", walk.floor);
  visit("path", walk.path);
  visit("frames", walk.frames);
  visit("speed_m_s", walk.speed_m_s);
  visit("paces", walk.paces);
  visit("stops", walk.stops);
  visit("cuts", walk.cuts);
  visit("unevenness", walk.unevenness);
  visit("shake", walk.shake);
  visit("tremor_deg", walk.tremor_deg);
  visit("jolt_deg", walk.jolt_deg);
  visit("passers_by", walk.passers_by);
  visit("standing", walk.standing);
  visit("crossing", walk.crossing);
  visit("ahead", walk.ahead);
  visit("day", walk.day);
  visit("conditions", walk.conditions);
}

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
