// How a hand holds a phone: how far off level, how it trembles, and what each step does to it.
#pragma once

#include <array>
#include <string>

#include "base/random.h"
#include "synth/world.h"

namespace vpr {

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
