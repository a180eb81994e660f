// A walk of a world: its path, how it is walked, in which light, and who else is there.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"

namespace vpr {

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

}  // namespace vpr
