// People who walk past the camera, or stand at the walls and occlude part of the view.
#pragma once

#include <array>
#include <vector>

#include "synth/surfaces.h"
#include "synth/walking.h"

namespace vpr {

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

/// All people on one walk.
class Crowd {
 public:
  Crowd(const World& world, const Walk& walk, const FloorPlan& plan,
        const std::vector<CameraPose>& poses, size_t people_count);
  /// All visible people at a time of the walk, in seconds.
  std::vector<Figure> at(double time_s) const;

 private:
  // Along the path; across it; or ahead of the camera, at its speed.
  enum class Motion { along, crosses, leads };
  struct Member {
    double path_m = 0;     // position on the path at time 0; leads: distance ahead of the camera
    double speed_m_s = 0;  // along the path; 0: stands
    double aside_m = 0;    // offset to the left of the path
    size_t person = 0;
    Motion motion = Motion::along;
    double from_s = 0;  // leads: start of visibility
    double to_s = 0;    // leads: its end; crosses: reaches the middle of the path at from_s
  };

  Member moved(const Member& member, double time_s) const;

  const FloorPlan& plan_;
  Path path_;
  std::vector<Member> members_;
  std::vector<double> camera_path_m_;  // of the frames
  double fps_;
};

}  // namespace vpr
