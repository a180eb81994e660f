#include "synth/hand.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace vpr {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr std::array<double, 2> kTremorHz = {4.7, 6.9};
constexpr double kJoltHz = 8;
constexpr double kJoltDecayS = 0.1;

}  // namespace

Hold::Hold(const World& world, const std::string& name) {
  const double hands = world.variety.hands;
  if (hands == 0) return;
  RandomEngine engine = named_engine(world.seed, "hand/" + name);
  const auto draw = [&](double most) { return hands * most * (2 * uniform_unit(engine) - 1); };
  height_m = draw(0.12);
  pitch_deg = draw(4);
  roll_deg = draw(2);
  heading_deg = draw(3);
  aside_m = draw(0.15);
  sway = std::max(0.2, 1 + draw(0.4));
}

Tremor::Tremor(RandomEngine& engine, double most_deg) : most_deg_(most_deg) {
  for (double& phase : phases_) phase = kTurn * uniform_unit(engine);
}

Swing Tremor::at(double time_s) const {
  double sines = 0, rates = 0;
  for (size_t i = 0; i < 2; ++i) {
    const double turned = kTurn * kTremorHz[i] * time_s + phases_[i];
    sines += std::sin(turned);
    rates += kTurn * kTremorHz[i] * std::cos(turned);
  }
  return {most_deg_ * sines / 2, most_deg_ * rates / 2};
}

Swing Jolt::at(double steps) const {
  if (most_deg_ == 0 || steps < 1) return {};
  const double struck = std::floor(steps);
  RandomEngine engine = named_engine(seed_, fmt::format("jolt/{}/{:.0f}", name_, struck));
  const double most = most_deg_ * (0.3 + 1.4 * uniform_unit(engine));
  const double since_s = (steps - struck) / kStepsPerS;
  const double pulse = kTurn * kJoltHz;
  const double left = most * std::exp(-since_s / kJoltDecayS);
  const double sine = std::sin(pulse * since_s), cosine = std::cos(pulse * since_s);
  return {left * sine, left * (pulse * cosine - sine / kJoltDecayS)};
}

}  // namespace vpr
