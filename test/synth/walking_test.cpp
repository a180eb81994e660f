// How a person walks and holds a phone, and the people who cross the path.
#include "synth/walking.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

/// Two corridors that meet at a corner, seen at 10 frames per second.
World corridor_world() {
  World world;
  world.fps = 10;
  Floor floor;
  floor.name = "f";
  floor.rooms = {{RoomKind::corridor, 0, 0, 20, 3}, {RoomKind::corridor, 17, 0, 3, 12}};
  world.floors = {floor};
  return world;
}

/// A walk of that world.
Walk walk_along(const std::vector<std::vector<double>>& path, uint64_t frames) {
  Walk walk;
  walk.name = "w";
  walk.floor = "f";
  walk.path = path;
  walk.frames = frames;
  return walk;
}

std::vector<CameraPose> poses(const World& world, const Walk& walk) {
  return walk_poses(world, walk, make_floor_plan(world.floors[0]));
}

/// 15 m along x at 1.2 m/s, without shake.
Walk straight_walk() {
  Walk walk = walk_along({{1, 1.5}, {16, 1.5}}, 0);
  walk.shake = 0;
  return walk;
}

constexpr double kTremorOnly = 1e-9;  // jolt_deg that is too small to be seen

/// Distance from the previous frame to this one in meters.
double step_m(const std::vector<CameraPose>& found, size_t i) {
  return found[i].path_m - found[i - 1].path_m;
}

struct Scenery {
  World world;
  FloorPlan plan;
  std::vector<CameraPose> poses;
  std::vector<std::vector<Figure>> people;  ///< at each pose

  // A walk of 20 s along x through a corridor 3 m wide.
  explicit Scenery(const Walk& settings) {
    world.fps = 10;
    Floor floor;
    floor.name = "f";
    floor.rooms = {{RoomKind::corridor, 0, 0, 40, 3}};
    world.floors = {floor};
    Walk walk = settings;
    walk.name = "w";
    walk.floor = "f";
    walk.path = {{1, 1.5}, {35, 1.5}};
    walk.frames = 201;
    walk.shake = 0;
    world.walks = {walk};
    plan = make_floor_plan(floor);
    poses = walk_poses(world, walk, plan);
    people = people_on_walk(world, walk, plan, poses, 14);
  }
};

Walk with(uint64_t Walk::*who, uint64_t groups) {
  Walk walk;
  walk.*who = groups;
  return walk;
}

}  // namespace

TEST_CASE("a walk without shake follows its path from end to end") {
  Walk walk = walk_along({{1, 1.5}, {16, 1.5}}, 101);
  walk.shake = 0;
  const auto found = poses(corridor_world(), walk);
  REQUIRE(found.size() == 101);
  CHECK(found.front().position.x == Approx(1));
  CHECK(found.back().position.x == Approx(16));
  CHECK(found.back().time_s == Approx(10));
  for (size_t i = 0; i < found.size(); ++i) {
    CHECK(found[i].position.y == Approx(1.5));
    CHECK(found[i].heading_deg == Approx(0).margin(1e-9));
    if (i == 0) continue;
    const double step = found[i].position.x - found[i - 1].position.x;
    CHECK(step > 0.1);  // 0.15 m on average, with natural variation
    CHECK(step < 0.2);
  }
}

TEST_CASE("the speed determines the number of frames if none is set") {
  Walk walk = walk_along({{1, 1.5}, {13, 1.5}}, 0);
  walk.speed_m_s = 1.2;
  CHECK(poses(corridor_world(), walk).size() == 101);  // 12 m at 0.12 m per frame
}

TEST_CASE("a corner is rounded, and the heading turns by 90 degrees without a jump") {
  Walk walk = walk_along({{1, 1.5}, {18.5, 1.5}, {18.5, 11}}, 300);
  walk.shake = 0;
  const auto found = poses(corridor_world(), walk);
  CHECK(found.front().heading_deg == Approx(0).margin(1e-9));
  CHECK(found.back().heading_deg == Approx(90));
  double most = 0;
  for (size_t i = 1; i < found.size(); ++i)
    most = std::max(most, heading_difference(found[i].heading_deg, found[i - 1].heading_deg));
  CHECK(most < 12);
}

TEST_CASE("equal walks have equal poses, another name other poses") {
  const World world = corridor_world();
  const Walk walk = walk_along({{1, 1.5}, {16, 1.5}}, 50);
  Walk other = walk;
  other.name = "v";
  const auto a = poses(world, walk), b = poses(world, walk), c = poses(world, other);
  bool differs = false;
  for (size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i].position.x == b[i].position.x);
    CHECK(a[i].heading_deg == b[i].heading_deg);
    differs = differs || a[i].heading_deg != c[i].heading_deg;
  }
  CHECK(differs);
}

TEST_CASE("each walk keeps its own distance from each leg of its path") {
  World world = corridor_world();
  Walk walk = walk_along({{1, 1.5}, {18.5, 1.5}, {18.5, 11}}, 300);
  walk.shake = 0;
  const auto path = poses(world, walk);
  world.variety.line_m = 0.5;
  const auto line = poses(world, walk);
  const double y = line.front().position.y, x = line.back().position.x;
  CHECK(y != 1.5);
  CHECK(x != 18.5);
  CHECK(std::abs(y - 1.5) <= 0.5);
  CHECK(std::abs(x - 18.5) <= 0.5);
  for (const CameraPose& pose : line) {
    if (pose.position.x < 16.5) CHECK(pose.position.y == Approx(y));
    if (pose.position.y > 3.5) CHECK(pose.position.x == Approx(x));
  }
  CHECK(line.back().position.y == Approx(path.back().position.y));
  walk.name = "v";
  CHECK(poses(world, walk).front().position.y != y);
  walk.path = {
      {1, 1.5}, {9, 1.5}, {9, 1.5}, {16, 1.5}, {9, 1.5}};  // repeated, straight on, and back
  for (const CameraPose& pose : poses(world, walk)) CHECK(std::abs(pose.position.y - 1.5) <= 0.5);
}

TEST_CASE("lost frames leave bursts of gaps between as many frames, in the same time") {
  World world = corridor_world();
  Walk walk = walk_along({{1, 1.5}, {16, 1.5}}, 101);
  walk.shake = 0;
  world.lost_frames = 0.2;  // of 126 frames, 12.5 per second
  const auto found = poses(world, walk);
  REQUIRE(found.size() == 101);
  CHECK(found.front().position.x == Approx(1));
  CHECK(found.back().position.x == Approx(16));
  CHECK(found.back().time_s == Approx(10));
  size_t gaps = 0, lost = 0;
  for (size_t i = 1; i < found.size(); ++i) {
    const double frames = (found[i].time_s - found[i - 1].time_s) * 12.5;
    const auto missing = static_cast<size_t>(std::lround(frames)) - 1;
    CHECK(frames == Approx(static_cast<double>(missing) + 1));
    gaps += missing > 0 ? 1 : 0;
    lost += missing;
  }
  CHECK(lost == 25);
  CHECK(gaps < 20);  // bursts of one to three
  CHECK(gaps > 5);
  walk.frames = 0;
  walk.cuts = {{5, 10}};
  const auto cut = poses(world, walk);
  CHECK(std::ranges::count(cut, true, &CameraPose::follows_cut) == 1);
}

TEST_CASE("a walk with one corner stands still, and one with one frame is at its start") {
  Walk standing = walk_along({{5, 1.5}}, 20);
  standing.shake = 0;
  for (const CameraPose& pose : poses(corridor_world(), standing)) {
    CHECK(pose.position.x == Approx(5));
    CHECK(pose.heading_deg == Approx(0).margin(1e-9));
  }
  Walk one = walk_along({{1, 1.5}, {16, 1.5}}, 1);
  one.shake = 0;
  const auto found = poses(corridor_world(), one);
  REQUIRE(found.size() == 1);
  CHECK(found[0].position.x == Approx(1));
}

TEST_CASE("a repeated corner counts once") {
  const Walk once = walk_along({{1, 1.5}, {18.5, 1.5}, {18.5, 11}}, 60);
  const Walk twice = walk_along({{1, 1.5}, {18.5, 1.5}, {18.5, 1.5}, {18.5, 11}}, 60);
  const auto a = poses(corridor_world(), once), b = poses(corridor_world(), twice);
  for (size_t i = 0; i < a.size(); ++i) CHECK(a[i].position.x == b[i].position.x);
}

TEST_CASE("a walk through a wall is an error with the point") {
  const World world = corridor_world();
  CHECK(error_kind([&] { poses(world, walk_along({{1, 1.5}, {16, 8}}, 50)); }) == ErrorKind::usage);
}

TEST_CASE("differences of headings use the shorter direction") {
  CHECK(heading_difference(350, 20) == Approx(30));
  CHECK(heading_difference(-170, 170) == Approx(20));
  CHECK(heading_difference(0, 180) == Approx(180));
}

TEST_CASE("a walk has the specified speeds, each from its point on") {
  Walk walk = straight_walk();
  walk.speed_m_s = 1.2;
  walk.paces = {{5, 0.6}, {10, 2.2}};
  const auto found = poses(corridor_world(), walk);
  for (size_t i = 1; i < found.size(); ++i) {
    const double from = found[i - 1].path_m;
    const double speed = from < 5 ? 1.2 : from < 10 ? 0.6 : 2.2;
    INFO("frame " << i << " from " << from);
    CHECK(step_m(found, i) >= 0.85 * speed / 10);  // with natural variation
    CHECK(step_m(found, i) <= 1.15 * speed / 10);
    CHECK(found[i].position.x == Approx(1 + found[i].path_m));
  }
  CHECK(found.back().path_m > 15 - 0.26);
  CHECK(found.back().path_m <= 15);
}

TEST_CASE("a walk stops at the specified points and for the specified time, without steps") {
  Walk walk = straight_walk();
  walk.shake = 1;
  walk.stops = {{4, 2.5}, {4, 0.2}, {9, 1}};
  const auto found = poses(corridor_world(), walk);
  const auto standing_at = [&](double way) {
    return std::count_if(found.begin(), found.end(),
                         [&](const CameraPose& pose) { return pose.path_m == way; });
  };
  CHECK(standing_at(4) == 25 + 1 + 2 + 1);  // each stop follows the frame that reaches it
  CHECK(standing_at(9) == 10 + 1);
  const auto at = std::find_if(found.begin(), found.end(),
                               [](const CameraPose& pose) { return pose.path_m == 9; });
  for (auto pose = at + 1; pose->path_m == 9; ++pose) {
    CHECK(pose->height_m == at->height_m);  // the body does not bob,
    CHECK(pose->time_s > at->time_s);
    CHECK(pose->heading_deg != at->heading_deg);  // but the hand drifts
  }
}

TEST_CASE("a cut continues the walk further on or back, without blur") {
  Walk walk = straight_walk();
  walk.cuts = {{0, 3}, {6, 11}, {13, 8}, {9, 14}};
  const auto found = poses(corridor_world(), walk);
  CHECK(found.front().path_m == 3);
  std::vector<double> jumps;
  for (size_t i = 1; i < found.size(); ++i)
    if (std::abs(step_m(found, i)) > 0.2) {
      jumps.push_back(std::round(step_m(found, i)));
      CHECK(found[i].turn_deg_s == 0);
    }
  CHECK(jumps == std::vector<double>{5, -5, 5});
  CHECK(found.size() == Approx(7 / 0.12).margin(6));  // meters in all parts
}

TEST_CASE("stops and cuts that a walk does not reach are refused") {
  Walk walk = straight_walk();
  walk.stops = {{15.5, 1}};
  CHECK(has(error_text([&] { poses(corridor_world(), walk); }), "15.00 m long"));
  walk.stops = {{6, 1}, {4, 1}};
  CHECK(error_kind([&] { poses(corridor_world(), walk); }) == ErrorKind::usage);
  walk.stops.clear();
  walk.cuts = {{20, 3}};
  CHECK(has(error_text([&] { poses(corridor_world(), walk); }), "a cut at 20 m"));
  walk.cuts = {{5, 40}};
  CHECK(error_kind([&] { poses(corridor_world(), walk); }) == ErrorKind::usage);
  walk.cuts.clear();
  walk.paces = {{0, 0.05}};
  walk.stops = {{1, 3600}, {2, 3600}, {3, 3600}};
  CHECK(has(error_text([&] { poses(corridor_world(), walk); }), "the maximum is 100000"));
}

TEST_CASE("days differ by the requested amount in how the phone is held") {
  World world = corridor_world();
  Walk walk = straight_walk();
  const auto plain = poses(world, walk);
  world.variety.hands = 1;
  const auto held = poses(world, walk);
  walk.day = 1;
  const auto other = poses(world, walk);
  REQUIRE(held.size() == plain.size());
  for (size_t i = 0; i < held.size(); ++i) {
    CHECK(held[i].path_m == plain[i].path_m);
    // Constant along the walk, and within the limits of a hand.
    CHECK(held[i].height_m - plain[i].height_m == Approx(held[0].height_m - plain[0].height_m));
    CHECK(held[i].pitch_deg - plain[i].pitch_deg == Approx(held[0].pitch_deg - plain[0].pitch_deg));
    CHECK(std::abs(held[i].height_m - plain[i].height_m) <= 0.12);
    CHECK(std::abs(held[i].pitch_deg - plain[i].pitch_deg) <= 4);
    CHECK(distance(held[i].position, plain[i].position) <= 0.15);
  }
  CHECK(held[0].pitch_deg != plain[0].pitch_deg);
  CHECK(held[0].pitch_deg != other[0].pitch_deg);
}

TEST_CASE("walks and views of a day share how the phone is held") {
  World world = corridor_world();
  Walk walk = straight_walk();
  CHECK(held_on_day(world, 1, {}).pitch_deg == 0);
  world.variety.hands = 1;
  for (const uint64_t day : {0, 1}) {
    const CameraPose held = held_on_day(world, day, {});
    CHECK(held.pitch_deg != 0);
    CHECK(held.position.x == 0);
    walk.day = day;
    for (const char* name : {"a", "b"}) {
      walk.name = name;
      CHECK(poses(world, walk)[0].pitch_deg == held.pitch_deg);
      CHECK(poses(world, walk)[0].height_m == held.height_m);
    }
  }
  CHECK(held_on_day(world, 0, {}).pitch_deg != held_on_day(world, 1, {}).pitch_deg);
}

TEST_CASE("with jolts, a hand trembles around the direction of view, at the rates of its angles") {
  World world = corridor_world();
  world.fps = 500;  // so that differences of angles are rates
  Walk walk = straight_walk();
  walk.frames = 2000;
  const auto calm = poses(world, walk);
  walk.jolt_deg = kTremorOnly;
  const auto found = poses(world, walk);
  double most = 0, sum = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    const double nod = found[i].pitch_deg - calm[i].pitch_deg;
    most = std::max(most, std::abs(nod));
    sum += nod;
    CHECK(found[i].position.x == calm[i].position.x);
    if (i == 0) continue;
    const double rate = (found[i].pitch_deg - found[i - 1].pitch_deg) * world.fps;
    CHECK(found[i].nod_deg_s == Approx(rate).margin(1.5));
    const double turn =
        std::remainder(found[i].heading_deg - found[i - 1].heading_deg, 360.0) * world.fps;
    CHECK(found[i].turn_deg_s == Approx(turn).margin(1.5));
  }
  CHECK(most > 0.48);
  CHECK(most <= 0.6);
  CHECK(std::abs(sum / 2000) < 0.05);
}

TEST_CASE("a step jolts the camera at the rates of its angles, but not during a stop") {
  World world = corridor_world();
  world.fps = 1000;  // so that differences of angles are rates
  Walk walk = straight_walk();
  walk.frames = 2000;  // 3.6 steps
  walk.jolt_deg = kTremorOnly;
  const auto calm = poses(world, walk);
  walk.jolt_deg = 1;
  const auto found = poses(world, walk);
  double most = 0;
  size_t level = 0, strikes = 0;
  for (size_t i = 1; i < found.size(); ++i) {
    const double nod = found[i].pitch_deg - calm[i].pitch_deg;
    const double before = found[i - 1].pitch_deg - calm[i - 1].pitch_deg;
    most = std::max(most, std::abs(nod));
    level += std::abs(nod) < 0.01;
    const double rate = found[i].nod_deg_s - calm[i].nod_deg_s;
    strikes += std::abs(rate - (nod - before) * world.fps) > 4;
    CHECK(found[i].position.x == calm[i].position.x);
  }
  CHECK(strikes == 3);  // where the rate jumps between two frames
  CHECK(most > 0.2);
  CHECK(most < 1.7);
  CHECK(level > 200);  // before the first step, and after each one has decayed
  Walk renamed = walk;
  renamed.name = "v";
  renamed.jolt_deg = kTremorOnly;
  const auto other_calm = poses(world, renamed);
  renamed.jolt_deg = walk.jolt_deg;
  const auto other = poses(world, renamed);
  CHECK(other[1500].pitch_deg - other_calm[1500].pitch_deg !=
        Approx(found[1500].pitch_deg - calm[1500].pitch_deg));

  world.fps = 10;
  walk.frames = 0;
  walk.stops = {{3, 2}};
  const auto stopped = poses(world, walk);
  walk.jolt_deg = kTremorOnly;
  const auto quiet = poses(world, walk);
  size_t still = 0;
  for (size_t i = 1; i < stopped.size(); ++i) {
    if (stopped[i].path_m != stopped[i - 1].path_m) continue;
    CHECK(stopped[i].pitch_deg == quiet[i].pitch_deg);
    ++still;
  }
  CHECK(still == 20);
}

TEST_CASE("the exposure follows the frames within its lag, back to a cut") {
  const World world = corridor_world();  // 10 frames per second
  Walk walk = straight_walk();
  walk.cuts = {{6, 11}};
  const auto found = poses(world, walk);
  const auto metered = [&](size_t frame) { return metered_poses(world, walk, found, frame); };
  CHECK(metered(20).empty());
  walk.conditions.shutter_s = 0.03;
  CHECK(metered(0).empty());
  CHECK(metered(2).size() == 3);
  REQUIRE(metered(20).size() == 5);  // 0.4 s
  CHECK(metered(20).front().time_s == found[16].time_s);
  CHECK(metered(20).back().time_s == found[20].time_s);
  const auto cut = std::find_if(found.begin(), found.end(),
                                [](const CameraPose& pose) { return pose.follows_cut; });
  const auto first = static_cast<size_t>(cut - found.begin());
  CHECK(metered(first).empty());
  CHECK(metered(first + 1).size() == 2);
}

TEST_CASE("there are no people unless requested") {
  const Scenery empty{Walk()};
  for (const auto& figures : empty.people) CHECK(figures.empty());
}

TEST_CASE("people walk ahead of the camera for a while, in its path") {
  const Scenery scenery(with(&Walk::ahead, 1));
  size_t seen = 0;
  double most = 0;
  for (size_t i = 0; i < scenery.poses.size(); ++i)
    for (const Figure& figure : scenery.people[i]) {
      const double ahead = figure.position.x - scenery.poses[i].position.x;
      CHECK(ahead > 1);
      most = std::max(most, ahead);
      CHECK(std::abs(figure.position.y - 1.5) <= 1.5);
      ++seen;
    }
  CHECK(seen >= 10);
  CHECK(most < 4 + 0.3 + 20 * 0.15);
}

TEST_CASE("people cross the path from one side to the other, in front of the camera") {
  const Scenery scenery(with(&Walk::crossing, 1));
  std::vector<double> sideways, ahead;
  for (size_t i = 0; i < scenery.poses.size(); ++i) {
    const std::vector<Figure>& figures = scenery.people[i];
    if (figures.empty()) continue;
    sideways.push_back(figures[0].position.y - 1.5);
    if (std::abs(sideways.back()) < 0.2)
      ahead.push_back(figures[0].position.x - scenery.poses[i].position.x);
  }
  REQUIRE_FALSE(sideways.empty());
  CHECK(std::abs(sideways.front() - sideways.back()) > 2);  // from wall to wall
  CHECK((std::is_sorted(sideways.begin(), sideways.end()) ||
         std::is_sorted(sideways.rbegin(), sideways.rend())));
  REQUIRE_FALSE(ahead.empty());
  for (const double meters : ahead) {
    CHECK(meters > 0.7);
    CHECK(meters < 4.5);
  }
}
