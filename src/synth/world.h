// The input of vpr-synth: buildings as floor plans, and walks through them (vpr.world/3).
//
// Descriptions and bounds of fields are in VPR_FIELDS. Meters. x is to the right and y up on the
// plan; headings are in degrees, counterclockwise from x.
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
  double finishes = 0;
  double bareness = 0;
  double wear = 0;
  double window_light = 0;
  double far_view = 0;
  double reflections = 0;
  double changes = 0;
  double hands = 0;
  double line_m = 0;
};
VPR_FIELDS(BuildingVariety,
           (finishes, "Variation of paint, flooring, ceiling and lamps from room to room.",
            within(0, 1)),
           (bareness, "Share of walls with doors, windows and fittings only.", within(0, 1)),
           (wear, "Amount of stains, scuffs and faded paint.", within(0, 1)),
           (window_light, "Daylight through windows and glass fronts; 1: about as much as lamps.",
            within(0, 10)),
           (far_view, "Share of the outside that is far away.", within(0, 1)),
           (reflections, "Share of light that glass reflects.", within(0, 1)),
           (changes, "Share of places at walls that change from day to day.", within(0, 1)),
           (hands, "Variation of how a phone is held from day to day.", within(0, 3)),
           (line_m,
            "Maximum distance of a walk from its path, to both sides, in m; each walk draws one "
            "per leg between two corners.",
            within(0, 2)))

enum class WalkUse { train, query, pretrain };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<WalkUse> = {"train", "query",
                                                                        "pretrain"};

struct Conditions {
  double lamps = 1;
  double daylight = 1;
  double warmth = 0;
  double noise = 3;
  double shutter_s = 0;
};
VPR_FIELDS(Conditions, (lamps, "Artificial light; 1: all lamps on.", within(0, 10)),
           (daylight, "Daylight; 0: night, 1: noon.", within(0, 10)),
           (warmth, "White balance, from -1 (blue) to 1 (yellow).", within(-1, 1)),
           (noise, "Standard deviation of the sensor noise, in gray values.", within(0, 100)),
           (shutter_s,
            "Exposure time, in s, for motion blur, with an automatic exposure that lags by 0.4 s; "
            "0 or absent: 1/50 s, horizontally, without lag.",
            within(0, 1)))

/// The speed of a walk from this point of the path to the next WalkPace.
struct WalkPace {
  double from_m = 0;
  double speed_m_s = 1.2;
};
VPR_FIELDS(WalkPace, (from_m, "Start, in m.", within(0, 100'000), kRequired),
           (speed_m_s, "Mean speed from here on.", within(0.05, 100), kRequired))

struct WalkStop {
  double at_m = 0;
  double seconds = 5;
};
VPR_FIELDS(WalkStop, (at_m, "Position, in m.", within(0, 100'000), kRequired),
           (seconds, "Duration in seconds.", within(0, 3600)))

/// A point at which the recording is cut and continues elsewhere, further on or back.
struct WalkCut {
  double at_m = 0;
  double to_m = 0;
};
VPR_FIELDS(WalkCut, (at_m, "Position, in m; 0: start.", within(0, 100'000), kRequired),
           (to_m, "Next position, in m.", within(0, 100'000), kRequired))

struct Walk {
  std::string name;
  WalkUse use = WalkUse::train;
  std::string floor;
  std::vector<std::vector<double>> path;
  uint64_t frames = 0;
  double speed_m_s = 1.2;
  std::vector<WalkPace> paces;
  std::vector<WalkStop> stops;
  std::vector<WalkCut> cuts;
  double shake = 1;
  double jolt_deg = 0;
  uint64_t passers_by = 0;
  uint64_t standing = 0;
  uint64_t crossing = 0;
  uint64_t ahead = 0;
  uint64_t day = 0;
  Conditions conditions;
};
VPR_FIELDS(Walk, (name, "Name of the recording.", kRequired), (use, "Role of the recording."),
           (floor, "Name of the floor.", kRequired),
           (path, "Corners [x, y].", within(-500, 500), kRequired),
           (frames, "Frames; 0 or absent: as many as the speed gives.", within(0, 100'000)),
           (speed_m_s, "Mean speed; default: by frames.", within(0.05, 100)),
           (paces,
            "Other speeds along the walk, by from_m; in front of the first, speed_m_s. With paces, "
            "stops or cuts the frames follow from them."),
           (stops, "Stops of the walker, in the order of the walk."),
           (cuts,
            "Where the recording is cut and goes on elsewhere on the path, in the order in which "
            "they are met."),
           (shake, "Factor of hand motion.", within(0, 10)),
           (jolt_deg,
            "Camera shake per step, in degrees; above 0, the hand also trembles by 0.6 degrees, at "
            "5 to 7 Hz.",
            within(0, 5)),
           (passers_by, "Groups of 1 to 3 people who walk by.", within(0, 1000)),
           (standing, "Groups of 1 to 4 people who stand at the walls.", within(0, 1000)),
           (crossing, "Groups of 1 or 2 people who cross ahead of the camera.", within(0, 1000)),
           (ahead, "Groups of 1 to 3 people who walk ahead for 5 to 20 s.", within(0, 1000)),
           (day, "Day of the walk; the building and the hand change from day to day."),
           (conditions, "Light, and how well the camera does."))

/// Whether a walk has its own speeds, stops or cuts, which determine its number of frames.
bool is_uneven(const Walk& walk);

/// Halls are wider and brighter than corridors and have other furnishings.
enum class RoomKind { corridor, hall };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<RoomKind> = {"corridor", "hall"};

/// A walkable rectangle. There is no wall between rooms that touch or overlap.
struct Room {
  RoomKind kind = RoomKind::corridor;
  double x = 0;
  double y = 0;
  double width = 0;
  double depth = 0;
  double lamp_spacing_m = 0;

  /// Left and bottom are inclusive, right and top exclusive.
  bool contains(double at_x, double at_y) const {
    return at_x >= x && at_y >= y && at_x < x + width && at_y < y + depth;
  }
};
VPR_FIELDS(Room, (kind, "Kind of the room."),
           (x, "Left edge, in m, multiple of 0.5.", within(-500, 500), kRequired),
           (y, "Lower edge, in meters.", within(-500, 500), kRequired),
           (width, "To the right, in meters.", within(0.5, 500), kRequired),
           (depth, "Upwards, in meters.", within(0.5, 500), kRequired),
           (lamp_spacing_m, "Meters between lamps; 0 or absent: 3, in halls 4.", within(0, 500)))

/// A square pillar of kPlanCellM, by its lower left corner.
struct Pillar {
  double x = 0;
  double y = 0;
};
VPR_FIELDS(Pillar, (x, "Left edge, in meters.", within(-500, 500), kRequired),
           (y, "Lower edge, in meters.", within(-500, 500), kRequired))

/// Walls along this line are glass fronts with daylight outside.
struct GlassFront {
  double from_x = 0;
  double from_y = 0;
  double to_x = 0;
  double to_y = 0;
};
VPR_FIELDS(GlassFront, (from_x, "Start of the line, in meters.", within(-500, 500), kRequired),
           (from_y, "Start of the line, in meters.", within(-500, 500), kRequired),
           (to_x, "End of the line, in meters.", within(-500, 500), kRequired),
           (to_y, "End of the line, in meters.", within(-500, 500), kRequired))

/// One floor of a building. With `like`, it uses the plan of another floor and a share of
/// `resemblance` of its furnishing.
struct Floor {
  std::string name;
  std::string like;
  double resemblance = 0.8;
  double renovated = 0;
  std::vector<Room> rooms;
  std::vector<Pillar> pillars;
  std::vector<GlassFront> glass;
};
VPR_FIELDS(Floor, (name, "Name of the floor.", kRequired), (like, "Floor with the same plan."),
           (resemblance, "Share of furnishing of the floor `like`.", within(0, 1)),
           (renovated,
            "Share of rooms whose paint, flooring and lamps differ from those of the floor `like`.",
            within(0, 1)),
           (rooms, "Rectangles to walk in; where they touch or overlap there is no wall."),
           (pillars, "Square pillars of half a meter."),
           (glass, "Lines along which walls are glass with daylight behind."))

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
VPR_FIELDS(WorldPlace, (name, "Name of the place.", kRequired),
           (floor, "Name of its floor.", kRequired),
           (x, "In meters.", within(-500, 500), kRequired),
           (y, "In meters.", within(-500, 500), kRequired),
           (headings, "Headings of the views, in degrees counterclockwise from x.",
            within(-360, 360), kRequired))

enum class FrameFormat { jpg, png };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<FrameFormat> = {"jpg", "png"};

struct World {
  std::string name;
  uint64_t seed = 1;
  double fps = 8;
  double lost_frames = 0;
  uint64_t image_width = 640;
  uint64_t image_height = 480;
  FrameFormat format = FrameFormat::jpg;
  double resemblance = 0.5;
  BuildingVariety variety;
  double same_place_m = 1.5;
  double ignore_m = 3;
  std::vector<Floor> floors;
  std::vector<WorldPlace> places;
  std::vector<Walk> walks;
};
VPR_FIELDS(World, (name, "Name of the building."), (seed, "Seed of everything that is not stated."),
           (fps, "Mean rate of the recorded frames, per second.", within(0.1, 1000)),
           (lost_frames,
            "Share of the camera's frames that are lost, in bursts of one to three; the camera is "
            "that much faster than fps.",
            within(0, 0.5)),
           (image_width, "In pixels.", within(32, 4096)),
           (image_height, "In pixels.", within(32, 4096)), (format, "Image format."),
           (resemblance, "Share of furnishing that all corridors have in common.", within(0, 1)),
           (variety, "Differences between parts of a building, days and walks; each is off at 0."),
           (same_place_m, "Largest distance of frames of the same place, in m.", within(0, 500)),
           (ignore_m, "Largest distance of ignored pairs, in m.", within(0, 500)),
           (floors, "Plans of the floors; meters, x to the right, y up.", kRequired),
           (places, "Places of FAB-MAP: one view in each heading."),
           (walks, "Recordings.", kRequired))

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
