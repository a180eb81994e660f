#include "synth/walking.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/error.h"
#include "base/random.h"
#include "synth/progress.h"

namespace vpr {
namespace {

constexpr double kCornerM = 0.9;  // distance from a corner at which a turn begins
constexpr int kCornerPoints = 12;
constexpr double kLookAheadM = 0.7;
constexpr double kTurn = 2 * std::numbers::pi;

Point between_points(Point a, Point b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

// A slow, smooth variation between about -1 and 1: the sum of two waves without a common period.
struct Wander {
  double first_phase;
  double second_phase;

  explicit Wander(RandomEngine& engine)
      : first_phase(kTurn * uniform_unit(engine)), second_phase(kTurn * uniform_unit(engine)) {}
  double at(double value, double period) const {
    return 0.6 * std::sin(kTurn * value / period + first_phase) +
           0.4 * std::sin(kTurn * value / (0.37 * period) + second_phase);
  }
};

void check_open(const Walk& walk, const FloorPlan& plan, Point point) {
  for (const auto& [dx, dy] : {std::pair(0.25, 0.0), {-0.25, 0.0}, {0.0, 0.25}, {0.0, -0.25}})
    if (!plan.is_open({point.x + dx, point.y + dy}))
      throw Error(ErrorKind::usage,
                  fmt::format("the walk {} comes too close to a wall at x {:.2f}, y {:.2f}; move "
                              "its path, or lower its shake",
                              walk.name, point.x, point.y));
}

double in_turn(double degrees) { return degrees - 360 * std::floor(degrees / 360); }

constexpr std::array<double, 2> kTremorHz = {4.7, 6.9};
constexpr double kJoltHz = 8;
constexpr double kJoltDecayS = 0.1;

}  // namespace

Path::Path(const std::vector<std::vector<double>>& given) {
  std::vector<std::vector<double>> corners = given;
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  const auto corner = [&](size_t i) { return Point{corners[i][0], corners[i][1]}; };
  points_.push_back(corner(0));
  for (size_t i = 1; i + 1 < corners.size(); ++i) {
    const Point before = corner(i - 1), here = corner(i), after = corner(i + 1);
    const double in = distance(before, here), out = distance(here, after);
    const double turn = std::min({kCornerM, in / 2, out / 2});
    const Point enter = between_points(here, before, turn / in);
    const Point leave = between_points(here, after, turn / out);
    for (int k = 0; k <= kCornerPoints; ++k) {  // a quadratic Bezier curve
      const double t = static_cast<double>(k) / kCornerPoints;
      points_.push_back(
          between_points(between_points(enter, here, t), between_points(here, leave, t), t));
    }
  }
  if (corners.size() > 1) points_.push_back(corner(corners.size() - 1));
  way_.push_back(0);
  for (size_t i = 1; i < points_.size(); ++i)
    way_.push_back(way_.back() + distance(points_[i - 1], points_[i]));
}

Point Path::at(double way_m) const {
  if (way_m <= 0 || points_.size() == 1) return points_.front();
  const auto next = std::lower_bound(way_.begin(), way_.end(), way_m);
  if (next == way_.end()) return points_.back();
  const auto i = static_cast<size_t>(next - way_.begin());
  const double step = way_[i] - way_[i - 1];
  return between_points(points_[i - 1], points_[i], step == 0 ? 0 : (way_m - way_[i - 1]) / step);
}

double Path::heading_at(double way_m) const {
  const double behind = std::clamp(way_m - kLookAheadM / 2, 0.0, std::max(0.0, length_m() - 0.1));
  const double ahead = std::min(behind + 1.5 * kLookAheadM, length_m());
  const Point from = at(behind), to = at(ahead);
  if (from.x == to.x && from.y == to.y) return 0;
  return std::atan2(to.y - from.y, to.x - from.x) * 360 / kTurn;
}

double heading_difference(double a_deg, double b_deg) {
  return std::abs(std::remainder(a_deg - b_deg, 360.0));
}

std::vector<CameraPose> walk_poses(const World& world, const Walk& walk, const FloorPlan& plan) {
  RandomEngine engine = named_engine(world.seed, "walk/" + walk.name);
  const Wander pace(engine), side(engine), look(engine), nod(engine), tilt(engine), light(engine);
  const double step_phase = uniform_unit(engine);
  const Hold hold(world, walk.name);
  const double shake = walk.shake * hold.sway;
  RandomEngine nerves = named_engine(world.seed, "tremor/" + walk.name);
  const Tremor turning(nerves, walk.tremor_deg), nodding(nerves, walk.tremor_deg);
  const Jolt jolt_up(world.seed, walk.name + "/up", walk.jolt_deg);
  const Jolt jolt_aside(world.seed, walk.name + "/aside", walk.jolt_deg / 2);
  const Path path(walk.path);
  const auto variation = [&](double time_s) { return walk.unevenness * pace.at(time_s, 11); };
  const auto progress = is_uneven(walk) ? uneven_progress : even_progress;
  const std::vector<Progress> frames = progress(world, walk, path.length_m(), variation);
  std::vector<CameraPose> poses;
  for (const Progress& now : frames) {
    CameraPose pose;
    pose.time_s = static_cast<double>(poses.size()) / world.fps;
    pose.way_m = now.way_m;
    const double step = kTurn * (kStepsPerS * now.walking_s + step_phase);
    const double heading = path.heading_at(pose.way_m);
    const double aside =
        shake * (0.15 * side.at(pose.way_m, 13) + 0.02 * std::sin(step / 2)) + hold.aside_m;
    const double normal = (heading + 90) * kTurn / 360;
    const Point on_path = path.at(pose.way_m);
    pose.position = {on_path.x + aside * std::cos(normal), on_path.y + aside * std::sin(normal)};
    check_open(walk, plan, pose.position);
    const double turned = heading + hold.heading_deg +
                          shake * (1.5 * look.at(pose.time_s, 7) + 0.8 * std::sin(step / 2 + 1));
    pose.heading_deg = in_turn(turned);
    pose.height_m = kEyeHeightM + hold.height_m + shake * 0.012 * std::sin(step);
    pose.pitch_deg =
        hold.pitch_deg + shake * (0.7 * nod.at(pose.time_s, 5) + 0.4 * std::sin(step + 2));
    pose.roll_deg =
        hold.roll_deg + shake * (0.7 * tilt.at(pose.time_s, 6) + 0.5 * std::sin(step / 2 + 3));
    pose.light_drift = 1 + 0.05 * light.at(pose.time_s, 8);
    pose.follows_cut = now.follows_cut;
    if (!poses.empty() && !now.follows_cut) {
      pose.turn_deg_s =
          std::remainder(pose.heading_deg - poses.back().heading_deg, 360.0) * world.fps;
      pose.nod_deg_s = (pose.pitch_deg - poses.back().pitch_deg) * world.fps;
    }
    poses.push_back(pose);
  }
  for (size_t i = 0; i < poses.size(); ++i) {
    const bool stands = i > 0 && frames[i].walking_s == frames[i - 1].walking_s;
    const double steps = stands ? 0 : kStepsPerS * frames[i].walking_s + step_phase;
    for (const Swing& turn : {turning.at(poses[i].time_s), jolt_aside.at(steps)}) {
      poses[i].heading_deg = in_turn(poses[i].heading_deg + turn.angle_deg);
      poses[i].turn_deg_s += turn.rate_deg_s;
    }
    for (const Swing& turn : {nodding.at(poses[i].time_s), jolt_up.at(steps)}) {
      poses[i].pitch_deg += turn.angle_deg;
      poses[i].nod_deg_s += turn.rate_deg_s;
    }
  }
  return poses;
}

std::vector<CameraPose> metered_poses(const World& world, const Walk& walk,
                                      const std::vector<CameraPose>& poses, size_t frame) {
  const auto lag = static_cast<size_t>(std::lround(walk.conditions.exposure_lag_s * world.fps));
  size_t first = frame;
  while (first > 0 && frame - first < lag && !poses[first].follows_cut) --first;
  if (first == frame) return {};
  const auto start = poses.begin();
  return {start + static_cast<std::ptrdiff_t>(first),
          start + static_cast<std::ptrdiff_t>(frame) + 1};
}

CameraPose held_by(const World& world, const std::string& name, CameraPose pose) {
  const Hold hold(world, name);
  pose.height_m += hold.height_m;
  pose.pitch_deg += hold.pitch_deg;
  pose.roll_deg += hold.roll_deg;
  pose.heading_deg += hold.heading_deg;
  return pose;
}

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
