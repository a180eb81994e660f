// How a person walks along a path and holds a phone: where the camera is and looks, frame by frame.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/random.h"
#include "synth/floor_plan.h"
#include "synth/world.h"

namespace vpr {

/// A path with rounded corners, by the way walked.
class Path {
 public:
  explicit Path(const std::vector<std::vector<double>>& corners);
  double length_m() const { return way_.back(); }
  /// Clamped to the ends.
  Point at(double way_m) const;
  /// Degrees; where one looks who walks there, a little ahead.
  double heading_at(double way_m) const;

 private:
  std::vector<Point> points_;
  std::vector<double> way_;  // metres from the start, as points_
};

/// Where a camera is, and which way it looks.
struct CameraPose {
  double time_s = 0;
  double way_m = 0;  ///< along the path
  Point position;
  double heading_deg = 0;  ///< 0 to 360
  double height_m = kEyeHeightM;
  double pitch_deg = 0;      ///< up
  double roll_deg = 0;       ///< clockwise
  double turn_deg_s = 0;     ///< for motion blur, as is
  double nod_deg_s = 0;      ///< how fast the pitch changes
  double light_drift = 1;    ///< of the automatic exposure
  bool follows_cut = false;  ///< the recording was cut just before
};

/// The poses of a walk's frames: path, speed with natural variation, sway of body and hand.
/// A path of one corner is a person who stands there and looks along x. Throws Error(usage), naming
/// the point, if the walk runs into a wall, or has too many frames.
std::vector<CameraPose> walk_poses(const World& world, const Walk& walk, const FloorPlan& plan);

/// A pose as somebody holds the phone who is called `name`: higher or lower, askew, by
/// variety.hands.
CameraPose held_by(const World& world, const std::string& name, CameraPose pose);

/// The poses that an automatic exposure follows at one of a walk's frames, that one the last: as
/// many before it as its lag takes, back to a cut. None where it follows that frame alone.
std::vector<CameraPose> metered_poses(const World& world, const Walk& walk,
                                      const std::vector<CameraPose>& poses, size_t frame);

/// Degrees between two headings, 0 to 180.
double heading_difference(double a_deg, double b_deg);

inline constexpr double kStepsPerS = 1.8;

/// How somebody holds the phone on one walk, beside the sway that all walks have.
struct Hold {
  double height_m = 0;
  double pitch_deg = 0;
  double roll_deg = 0;
  double heading_deg = 0;
  double aside_m = 0;
  double sway = 1;  ///< factor

  /// By variety.hands; level at 0.
  Hold(const World& world, const std::string& name);
};

/// An angle, and how fast it changes.
struct Swing {
  double angle_deg = 0;
  double rate_deg_s = 0;
};

/// How a hand trembles in one direction.
class Tremor {
 public:
  Tremor(RandomEngine& engine, double most_deg);
  Swing at(double time_s) const;

 private:
  double most_deg_;
  std::array<double, 2> phases_{};
};

/// How a step jolts what is carried: a damped vibration from the heel's strike on, of another
/// strength, 0.3 to 1.7, at every step.
class Jolt {
 public:
  /// `name` is that of the walk and of the direction; `most_deg` how far a step of strength 1 would
  /// swing the camera if nothing damped it.
  Jolt(uint64_t seed, std::string name, double most_deg)
      : seed_(seed), name_(std::move(name)), most_deg_(most_deg) {}
  /// After so many steps; the part behind the point is time since the last one struck.
  Swing at(double steps) const;

 private:
  uint64_t seed_;
  std::string name_;
  double most_deg_;
};

}  // namespace vpr
