// The input of vpr-synth: buildings as floor plans, and walks through them (vpr.world/3).
//
// Meters. x is to the right and y up on the plan; headings are in degrees, counterclockwise from x.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "base/json_fwd.h"

namespace vpr {

/// Variation between parts of a building, days and walks. A setting of 0 is off and changes no
/// other random number.
struct BuildingVariety {
  double finishes = 0;      ///< 0 to 1: paint, flooring, ceiling and lamps differ between rooms
  double bareness = 0;      ///< 0 to 1: share of walls with only doors, windows and fittings
  double wear = 0;          ///< 0 to 1: stains, scuffs, faded and repaired paint
  double window_light = 0;  ///< 0 to 10: daylight through windows and glass fronts
  double far_view = 0;      ///< 0 to 1: share of the outside that is too far away for parallax
  double reflections = 0;   ///< 0 to 1: share of light that glass reflects
  double changes = 0;       ///< 0 to 1: share of objects at walls that differ between days
  double hands = 0;         ///< 0 to 3: variation between days in how the phone is held
  /// 0 to 2: maximum distance of a walk from its path, to both sides; each walk draws one for each
  /// leg between two corners
  double line_m = 0;
};
VPR_FIELDS(BuildingVariety, finishes, bareness, wear, window_light, far_view, reflections, changes,
           hands, line_m)

enum class WalkUse { train, query, pretrain };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<WalkUse> = {"train", "query",
                                                                        "pretrain"};

struct Conditions {
  double lamps = 1;     ///< artificial light; 1: all lamps on
  double daylight = 1;  ///< 0: night, 1: noon
  double warmth = 0;    ///< white balance, -1 (blue) to 1 (yellow)
  double noise = 3;     ///< sensor noise, standard deviation in gray values
  /// exposure time that blurs all rotations, with a lag of the automatic exposure; 0: blur
  /// only horizontal ones, for 1/50 s, without lag
  double shutter_s = 0;
};
VPR_FIELDS(Conditions, lamps, daylight, warmth, noise, shutter_s)

/// The speed of a walk from this point of the path to the next WalkPace.
struct WalkPace {
  double from_m = 0;  ///< distance walked along the path
  double speed_m_s = 1.2;
};
VPR_FIELDS(WalkPace, from_m, speed_m_s)

struct WalkStop {
  double at_m = 0;  ///< along the path
  double seconds = 5;
};
VPR_FIELDS(WalkStop, at_m, seconds)

/// A point at which the recording is cut and continues elsewhere, further on or back.
struct WalkCut {
  double at_m = 0;  ///< along the path; 0: the walk begins at to_m
  double to_m = 0;
};
VPR_FIELDS(WalkCut, at_m, to_m)

struct Walk {
  std::string name;
  WalkUse use = WalkUse::train;
  std::string floor;
  std::vector<std::vector<double>> path;  ///< corners [x, y], which the walk rounds
  uint64_t frames = 0;                    ///< 0: determined by the speed
  double speed_m_s = 1.2;                 ///< mean; determined by `frames` if that is set
  std::vector<WalkPace> paces;            ///< by from_m; before the first one, speed_m_s applies
  std::vector<WalkStop> stops;            ///< in the order of the walk
  std::vector<WalkCut> cuts;              ///< as stops; with paces, stops or cuts, `frames` is 0
  double shake = 1;                       ///< factor on the sway and turns of a hand-held phone
  double jolt_deg = 0;  ///< amplitude of the camera's jolt at each step; above 0, the hand trembles
  uint64_t passers_by = 0;  ///< groups of one to three people who walk past
  uint64_t standing = 0;    ///< groups of one to four people who stand at the walls
  uint64_t crossing = 0;    ///< groups that cross the path in front of the camera
  uint64_t ahead = 0;       ///< groups that walk ahead of the camera for a while
  uint64_t day = 0;         ///< all walks of one day share its changes and its hand
  Conditions conditions;
};
VPR_FIELDS(Walk, name, use, floor, path, frames, speed_m_s, paces, stops, cuts, shake, jolt_deg,
           passers_by, standing, crossing, ahead, day, conditions)

/// Whether a walk has its own speeds, stops or cuts, which determine its number of frames.
bool is_uneven(const Walk& walk);

/// Halls are wider and brighter than corridors and have other furnishings.
enum class RoomKind { corridor, hall };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<RoomKind> = {"corridor", "hall"};

/// A walkable rectangle. There is no wall between rooms that touch or overlap.
struct Room {
  RoomKind kind = RoomKind::corridor;
  double x = 0;               ///< left; a multiple of kPlanCellM, as are the next three
  double y = 0;               ///< bottom
  double width = 0;           ///< to the right
  double depth = 0;           ///< upward
  double lamp_spacing_m = 0;  ///< approximate distance between lamps; 0: 3 m, in halls 4 m

  /// Left and bottom are inclusive, right and top exclusive.
  bool contains(double at_x, double at_y) const {
    return at_x >= x && at_y >= y && at_x < x + width && at_y < y + depth;
  }
};
VPR_FIELDS(Room, kind, x, y, width, depth, lamp_spacing_m)

/// A square pillar of kPlanCellM, by its lower left corner.
struct Pillar {
  double x = 0;
  double y = 0;
};
VPR_FIELDS(Pillar, x, y)

/// Walls along this line are glass fronts with daylight outside.
struct GlassFront {
  double from_x = 0;
  double from_y = 0;
  double to_x = 0;
  double to_y = 0;
};
VPR_FIELDS(GlassFront, from_x, from_y, to_x, to_y)

/// One floor of a building. With `like`, it uses the plan of another floor and a share of
/// `resemblance` of its furnishing.
struct Floor {
  std::string name;
  std::string like;
  double resemblance = 0.8;  ///< with `like`: share of equal objects
  double renovated = 0;  ///< with `like`: share of rooms with their own paint, flooring and lamps
  std::vector<Room> rooms;
  std::vector<Pillar> pillars;
  std::vector<GlassFront> glass;
};
VPR_FIELDS(Floor, name, like, resemblance, renovated, rooms, pillars, glass)

/// The smallest rectangle around all rooms of a floor.
struct FloorExtent {
  double left, bottom, right, top;
};
FloorExtent extent_of(const Floor& floor);

/// A place of FAB-MAP: one view per heading.
struct WorldPlace {
  std::string name;
  std::string floor;
  double x = 0;
  double y = 0;
  std::vector<double> headings;
};
VPR_FIELDS(WorldPlace, name, floor, x, y, headings)

enum class FrameFormat { jpg, png };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<FrameFormat> = {"jpg", "png"};

struct World {
  std::string name;
  uint64_t seed = 1;
  double fps = 8;  ///< mean rate of the recorded frames
  double lost_frames =
      0;  ///< share of the camera's frames that are lost, in bursts of one to three
  uint64_t image_width = 640;
  uint64_t image_height = 480;
  FrameFormat format = FrameFormat::jpg;
  double resemblance = 0.5;  ///< share of equal objects in all corridors
  BuildingVariety variety;
  double same_place_m = 1.5;  ///< frames within this distance and angle show the same place
  double ignore_m = 3;        ///< up to this distance, pairs are ignored
  std::vector<Floor> floors;
  std::vector<WorldPlace> places;
  std::vector<Walk> walks;
};
VPR_FIELDS(World, name, seed, fps, lost_frames, image_width, image_height, format, resemblance,
           variety, same_place_m, ignore_m, floors, places, walks)

/// The horizontal angle of view.
inline constexpr double kViewDeg = 66;
/// Frames of the same place have headings that differ by at most this angle.
inline constexpr double kSameHeadingDeg = 40;
/// A frame within this distance of a place, with the heading of a view, shows it; up to the second
/// distance, it is ignored.
inline constexpr double kPlaceRadiusM = 2.5;
inline constexpr double kPlaceIgnoreM = 5;
/// The cell size of floor plans, in meters.
inline constexpr double kPlanCellM = 0.5;
/// From floor to ceiling, in meters.
inline constexpr double kRoomHeightM = 2.9;
inline constexpr double kEyeHeightM = 1.45;  ///< height of the phone

/// Reads a world. Throws Error(input) if it cannot be read, Error(usage) if it is not a world or a
/// value is out of range.
World read_world(const std::filesystem::path& path);

/// The index of a floor, which exists in every world that was read.
size_t floor_index(const World& world, const std::string& name);

/// The floor whose plan this one uses: itself or the one it is like.
const Floor& plan_floor(const World& world, size_t floor);

}  // namespace vpr
