// People who walk by, or stand at the walls and cover part of the view.
#pragma once

#include <array>
#include <vector>

#include "base/random.h"
#include "synth/surfaces.h"
#include "synth/walking.h"

namespace vpr {

/// How wide the picture of a person is, in metres.
inline constexpr double kFigureWidthM = 0.8;
inline constexpr double kFigureHeightM = 1.9;  ///< of the picture; people are a little smaller

/// One person's looks: standing, and two halves of a step.
struct Looks {
  std::array<Texture, 3> postures;
};

/// A cast of people, the same for all walks of a world.
std::vector<Looks> make_cast(uint64_t seed);

/// A person at one moment: where, who of the cast, and in which posture.
struct Figure {
  Point position;
  size_t looks = 0;
  size_t posture = 0;
};

/// All people of one walk.
class Crowd {
 public:
  Crowd(const World& world, const Walk& walk, const FloorPlan& plan,
        const std::vector<CameraPose>& poses, size_t cast_size);
  /// Who is where at a time of the walk, in seconds.
  std::vector<Figure> at(double time_s) const;

 private:
  // Along the path; across it; or ahead of the camera, at its pace.
  enum class Motion { along, crosses, leads };
  struct Member {
    double way_m = 0;      // where on the path at time 0; leads: ahead of the camera
    double speed_m_s = 0;  // along the path; 0: stands
    double aside_m = 0;    // to the left of the path
    size_t looks = 0;
    Motion motion = Motion::along;
    double from_s = 0;  // leads: from here ...
    double to_s = 0;    // ... to here; crosses: in the middle of the way at from_s
  };

  void add_passers_by(RandomEngine& engine, const std::vector<CameraPose>& poses, size_t groups);
  void add_standing(RandomEngine& engine, size_t groups);
  void add_crossing(RandomEngine& engine, const std::vector<CameraPose>& poses, size_t groups);
  void add_ahead(RandomEngine& engine, const std::vector<CameraPose>& poses, size_t groups);
  double camera_way(double time_s) const;
  Member moved(const Member& member, double time_s) const;

  const FloorPlan& plan_;
  Path path_;
  size_t cast_size_;
  std::vector<Member> members_;
  std::vector<double> camera_ways_;  // of the frames
  double fps_;
};

}  // namespace vpr
