#include "synth/walking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "base/error.h"
#include "base/random.h"

namespace vpr {
namespace {

constexpr double kCornerM = 0.9;  // distance from a corner at which a turn begins
constexpr int kCornerPoints = 12;
constexpr double kLookAheadM = 0.7;
constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kStepsPerS = 1.8;
constexpr double kTremorDeg = 0.6;     // amplitude of the hand's tremor in walks with jolts
constexpr double kExposureLagS = 0.4;  // of the automatic exposure with a shutter time
constexpr double kUnevenness = 0.15;   // maximum relative variation of the speed
constexpr double kSharpTurn = 0.3;     // sine of the turn above which two moved legs meet
constexpr uint64_t kLongestBurst = 3;  // of lost frames

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
                  "the walk {} comes too close to a wall at x {:.2f}, y {:.2f}; move its path, or "
                  "lower its shake or variety.line_m",
                  walk.name, point.x, point.y);
}

double wrapped_degrees(double degrees) { return degrees - 360 * std::floor(degrees / 360); }

constexpr std::array<double, 2> kTremorHz = {4.7, 6.9};
constexpr double kJoltHz = 8;
constexpr double kJoltDecayS = 0.1;

/// The holding style on one day, in addition to the sway of all walks.
struct Hold {
  double height_m = 0;
  double pitch_deg = 0;
  double roll_deg = 0;
  double heading_deg = 0;
  double aside_m = 0;
  double sway = 1;  ///< factor

  /// Scaled by variety.hands; level if that is 0.
  Hold(const World& world, uint64_t day) {
    const double hands = world.variety.hands;
    if (hands == 0) return;
    RandomEngine engine = named_engine(world.seed, fmt::format("hand/{}", day));
    const auto draw = [&](double most) { return hands * most * (2 * uniform_unit(engine) - 1); };
    height_m = draw(0.12);
    pitch_deg = draw(4);
    roll_deg = draw(2);
    heading_deg = draw(3);
    aside_m = draw(0.15);
    sway = std::max(0.2, 1 + draw(0.4));
  }
};

/// An angle and its rate of change.
struct Swing {
  double angle_deg = 0;
  double rate_deg_s = 0;
};

/// The tremor of a hand in one direction.
class Tremor {
 public:
  Tremor(RandomEngine& engine, double most_deg) : most_deg_(most_deg) {
    for (double& phase : phases_) phase = kTurn * uniform_unit(engine);
  }
  Swing at(double time_s) const {
    double sines = 0, rates = 0;
    for (size_t i = 0; i < 2; ++i) {
      const double turned = kTurn * kTremorHz[i] * time_s + phases_[i];
      sines += std::sin(turned);
      rates += kTurn * kTremorHz[i] * std::cos(turned);
    }
    return {most_deg_ * sines / 2, most_deg_ * rates / 2};
  }

 private:
  double most_deg_;
  std::array<double, 2> phases_{};
};

// The jolt of the camera at a step: a damped vibration that starts when the heel strikes, with a
// random strength from 0.3 to 1.7 per step. `name` is the name of the walk and of the direction;
// `most_deg` is the amplitude of a step of strength 1 without damping; the fraction of `steps` is
// the time since the last step.
Swing jolt_at(uint64_t seed, const std::string& name, double most_deg, double steps) {
  if (most_deg == 0 || steps < 1) return {};
  const double struck = std::floor(steps);
  RandomEngine engine = named_engine(seed, fmt::format("jolt/{}/{:.0f}", name, struck));
  const double most = most_deg * (0.3 + 1.4 * uniform_unit(engine));
  const double since_s = (steps - struck) / kStepsPerS;
  const double pulse = kTurn * kJoltHz;
  const double left = most * std::exp(-since_s / kJoltDecayS);
  const double sine = std::sin(pulse * since_s), cosine = std::cos(pulse * since_s);
  return {left * sine, left * (pulse * cosine - sine / kJoltDecayS)};
}

// The corners of the line that a walk takes: each leg of its path moved aside by its own distance,
// at most variety.line_m, to the left or right.
std::vector<std::vector<double>> line_of(const World& world, const Walk& walk) {
  const double most = world.variety.line_m;
  std::vector<std::vector<double>> corners = walk.path;
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  const size_t count = corners.size();
  if (most == 0 || count < 2) return corners;
  RandomEngine engine = named_engine(world.seed, "line/" + walk.name);
  const auto corner = [&](size_t i) { return Point{corners[i][0], corners[i][1]}; };
  std::vector<Point> ways, moves;  // of the legs: unit vector, and shift to the side
  for (size_t i = 0; i + 1 < count; ++i) {
    const Point way = 1 / distance(corner(i), corner(i + 1)) * (corner(i + 1) - corner(i));
    ways.push_back(way);
    moves.push_back(most * (2 * uniform_unit(engine) - 1) * Point(-way.y, way.x));
  }
  std::vector<std::vector<double>> line;
  for (size_t i = 0; i < count; ++i) {
    const size_t in = i == 0 ? 0 : i - 1, out = std::min(i, ways.size() - 1);
    const double sine = ways[in].cross(ways[out]);
    Point moved = corner(i) + 0.5 * (moves[in] + moves[out]);
    if (std::abs(sine) > kSharpTurn) {  // where the moved legs meet
      const double along = (moves[out] - moves[in]).cross(ways[out]) / sine;
      moved = corner(i) + moves[in] + along * ways[in];
    }
    line.push_back({moved.x, moved.y});
  }
  return line;
}

// Which of `count` frames of the camera are recorded: all but the share world.lost_frames, which is
// lost in bursts of one to three frames. The first and the last frame are recorded.
std::vector<bool> recorded_frames(const World& world, const Walk& walk, size_t count,
                                  size_t recorded) {
  std::vector<bool> is_recorded(count, true);
  RandomEngine engine = named_engine(world.seed, "lost/" + walk.name);
  for (size_t left = count - recorded; left > 0;) {
    const uint64_t burst = 1 + uniform_below(engine, kLongestBurst);
    const uint64_t first = 1 + uniform_below(engine, count - 2);
    for (uint64_t i = first; i < std::min<uint64_t>(first + burst, count - 1) && left > 0; ++i) {
      if (!is_recorded[i]) continue;
      is_recorded[i] = false;
      --left;
    }
  }
  return is_recorded;
}

/// One frame of a walk.
struct Progress {
  double path_m = 0;         ///< along the path
  double walking_s = 0;      ///< time walked so far, without stops
  bool follows_cut = false;  ///< the recording was cut just before this frame
};

constexpr size_t kMaxFrames = 100'000;

void check_frames(const Walk& walk, double frames) {
  if (frames > static_cast<double>(kMaxFrames))
    throw Error(ErrorKind::usage, "the walk {} would have {} frames; the maximum is {}", walk.name,
                frames, kMaxFrames);
}

[[noreturn]] void refuse_missed(const Walk& walk, std::string_view what, double at_m,
                                double length_m) {
  throw Error(ErrorKind::usage,
              "the walk {} has a {} {} m, which it does not reach: its path is {:.2f} m long, and "
              "it passes stops and cuts in their order",
              walk.name, what, at_m, length_m);
}

// The frames of a walk along a path of `length_m`, at least one. `variation` returns the relative
// deviation from the stated speed at a time in seconds. The walk passes stops and cuts in their
// order. Frames are recorded during a stop, and the first frame after a cut is at the end of the
// step that reached it.
std::vector<Progress> uneven_progress(const World& world, const Walk& walk, double length_m,
                                      const std::function<double(double time_s)>& variation) {
  for (const WalkCut& known : walk.cuts)
    if (known.to_m > length_m) refuse_missed(walk, "cut to", known.to_m, length_m);
  std::vector<Progress> frames;
  Progress now;
  size_t stop = 0;
  size_t cut = 0;
  for (;;) {
    // Cuts before a step leaves this part; several cuts may follow each other.
    for (; cut < walk.cuts.size() && now.path_m >= walk.cuts[cut].at_m; ++cut) {
      now.path_m = walk.cuts[cut].to_m + (now.path_m - walk.cuts[cut].at_m);
      now.follows_cut = !frames.empty();
    }
    const double end_m =
        cut == walk.cuts.size() ? length_m : std::min(length_m, walk.cuts[cut].at_m);
    if (now.path_m > end_m) break;
    frames.push_back(now);
    now.follows_cut = false;
    check_frames(walk, static_cast<double>(frames.size()));
    if (stop < walk.stops.size() && walk.stops[stop].at_m == now.path_m) {
      const auto standing = static_cast<size_t>(std::floor(walk.stops[stop].seconds * world.fps));
      check_frames(walk, static_cast<double>(frames.size() + standing));
      frames.insert(frames.end(), standing, now);
      ++stop;
    }
    const double time_s = static_cast<double>(frames.size()) / world.fps;
    double speed = walk.speed_m_s;
    for (const WalkPace& pace : walk.paces)
      if (pace.from_m <= now.path_m) speed = pace.speed_m_s;
    double next = now.path_m + speed * (1 + variation(time_s)) / world.fps;
    const bool stands = stop < walk.stops.size() && walk.stops[stop].at_m >= now.path_m &&
                        walk.stops[stop].at_m <= std::min(next, end_m);
    if (stands) next = walk.stops[stop].at_m;
    now.path_m = next;
    now.walking_s += 1 / world.fps;
  }
  if (stop < walk.stops.size()) refuse_missed(walk, "stop at", walk.stops[stop].at_m, length_m);
  if (cut < walk.cuts.size()) refuse_missed(walk, "cut at", walk.cuts[cut].at_m, length_m);
  return frames;
}

// The frames of a walk that is not is_uneven: walk.frames, or a number determined by the speed,
// from end to end.
std::vector<Progress> even_progress(const World& world, const Walk& walk, double length_m,
                                    const std::function<double(double time_s)>& variation) {
  size_t count = walk.frames;
  if (count == 0) {
    const double frames = std::floor(length_m / walk.speed_m_s * world.fps) + 1;
    check_frames(walk, frames);
    count = static_cast<size_t>(frames);
  }
  std::vector<double> shares(count, 0);
  for (size_t i = 1; i < count; ++i)
    shares[i] = shares[i - 1] + 1 + variation(static_cast<double>(i) / world.fps);
  const double all = count > 1 ? shares.back() : 1;
  std::vector<Progress> frames;
  for (size_t i = 0; i < count; ++i)
    frames.push_back({shares[i] / all * length_m, static_cast<double>(i) / world.fps, false});
  return frames;
}

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
    const Point enter = here + turn / in * (before - here);
    const Point leave = here + turn / out * (after - here);
    for (int k = 0; k <= kCornerPoints; ++k) {  // a quadratic Bezier curve
      const double t = static_cast<double>(k) / kCornerPoints;
      const Point from = enter + t * (here - enter), to = here + t * (leave - here);
      points_.push_back(from + t * (to - from));
    }
  }
  if (corners.size() > 1) points_.push_back(corner(corners.size() - 1));
  way_.push_back(0);
  for (size_t i = 1; i < points_.size(); ++i)
    way_.push_back(way_.back() + distance(points_[i - 1], points_[i]));
}

Point Path::at(double path_m, double aside_m) const {
  Point point = path_m <= 0 ? points_.front() : points_.back();
  const auto next = std::lower_bound(way_.begin(), way_.end(), path_m);
  if (next != way_.begin() && next != way_.end()) {
    const auto i = static_cast<size_t>(next - way_.begin());
    const double step = way_[i] - way_[i - 1];
    const double share = step == 0 ? 0 : (path_m - way_[i - 1]) / step;
    point = points_[i - 1] + share * (points_[i] - points_[i - 1]);
  }
  if (aside_m == 0) return point;
  const double normal = (heading_at(path_m) + 90) * kTurn / 360;
  return point + aside_m * Point(std::cos(normal), std::sin(normal));
}

double Path::heading_at(double path_m) const {
  const double behind = std::clamp(path_m - kLookAheadM / 2, 0.0, std::max(0.0, length_m() - 0.1));
  const double ahead = std::min(behind + 1.5 * kLookAheadM, length_m());
  const Point way = at(ahead) - at(behind);
  return way == Point() ? 0 : std::atan2(way.y, way.x) * 360 / kTurn;
}

double heading_difference(double a_deg, double b_deg) {
  return std::abs(std::remainder(a_deg - b_deg, 360.0));
}

namespace {

// The poses of all frames of the camera, recorded or lost.
std::vector<CameraPose> camera_poses(const World& world, const Walk& walk, const FloorPlan& plan) {
  RandomEngine engine = named_engine(world.seed, "walk/" + walk.name);
  const Wander pace(engine), side(engine), look(engine), nod(engine), tilt(engine), light(engine);
  const double step_phase = uniform_unit(engine);
  const Hold hold(world, walk.day);
  const double shake = walk.shake * hold.sway;
  RandomEngine tremor_engine = named_engine(world.seed, "tremor/" + walk.name);
  const double tremor_deg = walk.jolt_deg > 0 ? kTremorDeg : 0;
  const Tremor turning(tremor_engine, tremor_deg), nodding(tremor_engine, tremor_deg);
  const Path path(line_of(world, walk));
  const auto variation = [&](double time_s) { return kUnevenness * pace.at(time_s, 11); };
  const auto progress = is_uneven(walk) ? uneven_progress : even_progress;
  const std::vector<Progress> frames = progress(world, walk, path.length_m(), variation);
  std::vector<CameraPose> poses;
  for (const Progress& now : frames) {
    CameraPose pose;
    pose.time_s = static_cast<double>(poses.size()) / world.fps;
    pose.path_m = now.path_m;
    const double step = kTurn * (kStepsPerS * now.walking_s + step_phase);
    const double heading = path.heading_at(pose.path_m);
    const double aside =
        shake * (0.15 * side.at(pose.path_m, 13) + 0.02 * std::sin(step / 2)) + hold.aside_m;
    pose.position = path.at(pose.path_m, aside);
    check_open(walk, plan, pose.position);
    const double turned = heading + hold.heading_deg +
                          shake * (1.5 * look.at(pose.time_s, 7) + 0.8 * std::sin(step / 2 + 1));
    pose.heading_deg = wrapped_degrees(turned);
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
    const auto jolt = [&](const char* direction, double most_deg) {
      return jolt_at(world.seed, walk.name + direction, most_deg, steps);
    };
    for (const Swing& turn : {turning.at(poses[i].time_s), jolt("/aside", walk.jolt_deg / 2)}) {
      poses[i].heading_deg = wrapped_degrees(poses[i].heading_deg + turn.angle_deg);
      poses[i].turn_deg_s += turn.rate_deg_s;
    }
    for (const Swing& turn : {nodding.at(poses[i].time_s), jolt("/up", walk.jolt_deg)}) {
      poses[i].pitch_deg += turn.angle_deg;
      poses[i].nod_deg_s += turn.rate_deg_s;
    }
  }
  return poses;
}

}  // namespace

std::vector<CameraPose> walk_poses(const World& world, const Walk& walk, const FloorPlan& plan) {
  if (world.lost_frames == 0) return camera_poses(world, walk, plan);
  const double kept = 1 - world.lost_frames;
  World camera = world;
  camera.fps = world.fps / kept;
  Walk seen = walk;
  if (walk.frames > 0)
    seen.frames = static_cast<size_t>(std::lround(static_cast<double>(walk.frames) / kept));
  const std::vector<CameraPose> all = camera_poses(camera, seen, plan);
  const size_t recorded =
      walk.frames > 0 ? walk.frames : static_cast<size_t>(static_cast<double>(all.size()) * kept);
  if (all.size() < 3 || recorded < 2) return all;
  const std::vector<bool> is_recorded = recorded_frames(world, walk, all.size(), recorded);
  std::vector<CameraPose> poses;
  bool follows_cut = false;
  for (size_t i = 0; i < all.size(); ++i) {
    follows_cut = follows_cut || all[i].follows_cut;
    if (!is_recorded[i]) continue;
    poses.push_back(all[i]);
    poses.back().follows_cut = follows_cut;
    follows_cut = false;
  }
  return poses;
}

std::vector<CameraPose> metered_poses(const World& world, const Walk& walk,
                                      const std::vector<CameraPose>& poses, size_t frame) {
  if (walk.conditions.shutter_s == 0) return {};
  const auto lag = static_cast<size_t>(std::lround(kExposureLagS * world.fps));
  size_t first = frame;
  while (first > 0 && frame - first < lag && !poses[first].follows_cut) --first;
  if (first == frame) return {};
  const auto start = poses.begin();
  return {start + static_cast<std::ptrdiff_t>(first),
          start + static_cast<std::ptrdiff_t>(frame) + 1};
}

CameraPose held_on_day(const World& world, uint64_t day, CameraPose pose) {
  const Hold hold(world, day);
  pose.height_m += hold.height_m;
  pose.pitch_deg += hold.pitch_deg;
  pose.roll_deg += hold.roll_deg;
  pose.heading_deg += hold.heading_deg;
  return pose;
}

}  // namespace vpr
