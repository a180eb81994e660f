// How a phone is held, and how the hand that holds it trembles.
#include "synth/hand.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "synth/corridor.h"

using namespace vpr;
using namespace vpr::test;

TEST_CASE("Walks differ in how the phone is held, as far as is asked for") {
  World world = corridor_world();
  Walk walk = straight_walk();
  const auto plain = poses(world, walk);
  world.variety.hands = 1;
  const auto held = poses(world, walk);
  walk.name = "other";
  const auto other = poses(world, walk);
  REQUIRE(held.size() == plain.size());
  for (size_t i = 0; i < held.size(); ++i) {
    CHECK(held[i].way_m == plain[i].way_m);
    // All along the walk alike, and within what a hand does.
    CHECK(held[i].height_m - plain[i].height_m == Approx(held[0].height_m - plain[0].height_m));
    CHECK(held[i].pitch_deg - plain[i].pitch_deg == Approx(held[0].pitch_deg - plain[0].pitch_deg));
    CHECK(std::abs(held[i].height_m - plain[i].height_m) <= 0.12);
    CHECK(std::abs(held[i].pitch_deg - plain[i].pitch_deg) <= 4);
    CHECK(distance(held[i].position, plain[i].position) <= 0.15);
  }
  CHECK(held[0].pitch_deg != plain[0].pitch_deg);
  CHECK(held[0].pitch_deg != other[0].pitch_deg);
}

TEST_CASE("A view of a place is held as its name says") {
  World world = corridor_world();
  const CameraPose level = {};
  CHECK(held_by(world, "a", level).pitch_deg == 0);
  world.variety.hands = 1;
  CHECK(held_by(world, "a", level).pitch_deg != 0);
  CHECK(held_by(world, "a", level).pitch_deg == held_by(world, "a", level).pitch_deg);
  CHECK(held_by(world, "a", level).pitch_deg != held_by(world, "b", level).pitch_deg);
  CHECK(held_by(world, "a", level).position.x == 0);
}

TEST_CASE("A hand trembles around where it looks, as fast as its angles say") {
  World world = corridor_world();
  world.fps = 500;  // so that differences of angles are rates
  Walk walk = straight_walk();
  walk.frames = 2000;
  const auto calm = poses(world, walk);
  walk.tremor_deg = 0.5;
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
  CHECK(most > 0.4);
  CHECK(most <= 0.5);
  CHECK(std::abs(sum / 2000) < 0.05);
}

TEST_CASE("A step jolts the camera as fast as its angles say, and not who stands") {
  World world = corridor_world();
  world.fps = 1000;  // so that differences of angles are rates
  Walk walk = straight_walk();
  walk.frames = 2000;  // 3.6 steps
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
  CHECK(strikes == 3);  // where the rate leaps, between two frames
  CHECK(most > 0.2);
  CHECK(most < 1.7);
  CHECK(level > 200);  // until the first step, and where one has died away

  world.fps = 10;
  walk.frames = 0;
  walk.stops = {{3, 2}};
  const auto stopped = poses(world, walk);
  walk.jolt_deg = 0;
  const auto quiet = poses(world, walk);
  size_t still = 0;
  for (size_t i = 1; i < stopped.size(); ++i) {
    if (stopped[i].way_m != stopped[i - 1].way_m) continue;
    CHECK(stopped[i].pitch_deg == quiet[i].pitch_deg);
    ++still;
  }
  CHECK(still == 20);
}

TEST_CASE("Jolts are those of their walk") {
  const Jolt one(1, "a/up", 1), same(1, "a/up", 1), other(1, "b/up", 1);
  CHECK(one.at(0.9).angle_deg == 0);
  CHECK(one.at(2.05).angle_deg == same.at(2.05).angle_deg);
  CHECK(one.at(2.05).angle_deg != other.at(2.05).angle_deg);
  CHECK(one.at(2.05).angle_deg != one.at(3.05).angle_deg);
  // A strike begins level, with a speed of 2 pi 8 Hz times 0.3 to 1.7 degrees.
  CHECK(one.at(2).angle_deg == 0);
  CHECK(one.at(2).rate_deg_s > 0.3 * 50.2);
  CHECK(one.at(2).rate_deg_s < 1.7 * 50.3);
  CHECK(std::abs(one.at(2.999).angle_deg) < 0.01);
}

TEST_CASE("The exposure follows the frames of its lag, back to a cut") {
  const World world = corridor_world();  // 10 frames a second
  Walk walk = straight_walk();
  walk.cuts = {{6, 11}};
  const auto found = poses(world, walk);
  const auto metered = [&](size_t frame) { return metered_poses(world, walk, found, frame); };
  CHECK(metered(20).empty());
  walk.conditions.exposure_lag_s = 0.3;
  CHECK(metered(0).empty());
  CHECK(metered(2).size() == 3);
  REQUIRE(metered(20).size() == 4);
  CHECK(metered(20).front().time_s == found[17].time_s);
  CHECK(metered(20).back().time_s == found[20].time_s);
  const auto cut = std::find_if(found.begin(), found.end(),
                                [](const CameraPose& pose) { return pose.follows_cut; });
  const auto first = static_cast<size_t>(cut - found.begin());
  CHECK(metered(first).empty());
  CHECK(metered(first + 1).size() == 2);
}
