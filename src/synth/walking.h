// A person who walks along a path with a phone, which determines the camera pose of each frame, and
// the people who walk past or stand at the walls and occlude part of the view.
#pragma once

#include <array>
#include <vector>

#include "synth/floor_plan.h"
#include "synth/surfaces.h"
#include "synth/world.h"

namespace vpr {

/// A path with rounded corners, parametrized by the distance walked.
class Path {
 public:
  explicit Path(const std::vector<std::vector<double>>& corners);
  double length_m() const { return way_.back(); }
  /// Clamped to the ends; `aside_m` is the distance to the left of the path.
  Point at(double path_m, double aside_m = 0) const;
  /// The heading of a person who walks there and looks slightly ahead, in degrees.
  double heading_at(double path_m) const;

 private:
  std::vector<Point> points_;
  std::vector<double> way_;  // meters from the start, one entry per point
};

struct CameraPose {
  double time_s = 0;
  double path_m = 0;  ///< along the path
  Point position;
  double heading_deg = 0;  ///< 0 to 360
  double height_m = kEyeHeightM;
  double pitch_deg = 0;      ///< upward
  double roll_deg = 0;       ///< clockwise
  double turn_deg_s = 0;     ///< for motion blur, as is nod_deg_s
  double nod_deg_s = 0;      ///< rate of change of the pitch
  double light_drift = 1;    ///< of the automatic exposure
  bool follows_cut = false;  ///< the recording was cut just before this frame
};

/// The poses of a walk's frames: path, speed with natural variation, sway of body and hand. A path
/// with a single corner is a person who stands there and looks along x. Throws Error(usage), with
/// the point, if the walk runs into a wall or has too many frames.
std::vector<CameraPose> walk_poses(const World& world, const Walk& walk, const FloorPlan& plan);

/// The pose with the holding style of a day: height and tilt of the phone, by variety.hands.
CameraPose held_on_day(const World& world, uint64_t day, CameraPose pose);

/// The poses that determine the automatic exposure at one frame of a walk: this frame and the
/// frames before it within the exposure lag, back to the last cut. Empty if only the frame itself
/// determines it.
std::vector<CameraPose> metered_poses(const World& world, const Walk& walk,
                                      const std::vector<CameraPose>& poses, size_t frame);

/// Degrees between two headings, 0 to 180.
double heading_difference(double a_deg, double b_deg);

/// Width of the image of a person, in meters.
inline constexpr double kFigureWidthM = 0.8;
inline constexpr double kFigureHeightM = 1.9;  ///< of the image; people are slightly smaller

/// The images of one person: standing, and two halves of a step.
struct PersonImages {
  std::array<Texture, 3> postures;
};

/// A set of people, the same for all walks of a world.
std::vector<PersonImages> make_people(uint64_t seed);

/// A person at one moment: position, index of the images, and posture.
struct Figure {
  Point position;
  size_t person = 0;
  size_t posture = 0;
};

/// The visible people at each pose of a walk; `people_count`: size of the set of people.
std::vector<std::vector<Figure>> people_on_walk(const World& world, const Walk& walk,
                                                const FloorPlan& plan,
                                                const std::vector<CameraPose>& poses,
                                                size_t people_count);

}  // namespace vpr
