#include "synth/walking.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "support.h"
#include "synth/corridor.h"

using namespace vpr;
using namespace vpr::test;

TEST_CASE("a walk without shake keeps to its path, from end to end") {
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

TEST_CASE("speed gives the number of frames where none is stated") {
  Walk walk = walk_along({{1, 1.5}, {13, 1.5}}, 0);
  walk.speed_m_s = 1.2;
  CHECK(poses(corridor_world(), walk).size() == 101);  // 12 m at 0.12 m a frame
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

TEST_CASE("the same walk has the same poses, another name other ones") {
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

TEST_CASE("a walk of one corner stands still, and one of one frame is at its start") {
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

TEST_CASE("a corner that is given twice counts once") {
  const Walk once = walk_along({{1, 1.5}, {18.5, 1.5}, {18.5, 11}}, 60);
  const Walk twice = walk_along({{1, 1.5}, {18.5, 1.5}, {18.5, 1.5}, {18.5, 11}}, 60);
  const auto a = poses(corridor_world(), once), b = poses(corridor_world(), twice);
  for (size_t i = 0; i < a.size(); ++i) CHECK(a[i].position.x == b[i].position.x);
}

TEST_CASE("a walk through a wall is an error that says where") {
  const World world = corridor_world();
  CHECK(test::error_kind([&] {
          poses(world, walk_along({{1, 1.5}, {16, 8}}, 50));
        }) == ErrorKind::usage);
}

TEST_CASE("differences of headings go the short way round") {
  CHECK(heading_difference(350, 20) == Approx(30));
  CHECK(heading_difference(-170, 170) == Approx(20));
  CHECK(heading_difference(0, 180) == Approx(180));
}

TEST_CASE("A walk has the paces that it states, each from its point on") {
  Walk walk = straight_walk();
  walk.speed_m_s = 1.2;
  walk.paces = {{5, 0.6}, {10, 2.2}};
  const auto found = poses(corridor_world(), walk);
  for (size_t i = 1; i < found.size(); ++i) {
    const double from = found[i - 1].way_m;
    const double speed = from < 5 ? 1.2 : from < 10 ? 0.6 : 2.2;
    INFO("frame " << i << " from " << from);
    CHECK(step_m(found, i) >= 0.85 * speed / 10);  // with natural variation
    CHECK(step_m(found, i) <= 1.15 * speed / 10);
    CHECK(found[i].position.x == Approx(1 + found[i].way_m));
  }
  CHECK(found.back().way_m > 15 - 0.26);
  CHECK(found.back().way_m <= 15);
}

TEST_CASE("A walk stands where and as long as it states, and its steps stand, too") {
  Walk walk = straight_walk();
  walk.shake = 1;
  walk.stops = {{4, 2.5}, {4, 0.2}, {9, 1}};
  const auto found = poses(corridor_world(), walk);
  const auto standing_at = [&](double way) {
    return std::count_if(found.begin(), found.end(),
                         [&](const CameraPose& pose) { return pose.way_m == way; });
  };
  CHECK(standing_at(4) == 25 + 1 + 2 + 1);  // each stop after the frame that comes to it
  CHECK(standing_at(9) == 10 + 1);
  const auto at = std::find_if(found.begin(), found.end(),
                               [](const CameraPose& pose) { return pose.way_m == 9; });
  for (auto pose = at + 1; pose->way_m == 9; ++pose) {
    CHECK(pose->height_m == at->height_m);  // the body does not bob,
    CHECK(pose->time_s > at->time_s);
    CHECK(pose->heading_deg != at->heading_deg);  // but the hand drifts
  }
}

TEST_CASE("A walk that is cut goes on elsewhere, further on or back, without blur") {
  Walk walk = straight_walk();
  walk.cuts = {{0, 3}, {6, 11}, {13, 8}, {9, 14}};
  const auto found = poses(corridor_world(), walk);
  CHECK(found.front().way_m == 3);
  std::vector<double> jumps;
  for (size_t i = 1; i < found.size(); ++i)
    if (std::abs(step_m(found, i)) > 0.2) {
      jumps.push_back(std::round(step_m(found, i)));
      CHECK(found[i].turn_deg_s == 0);
    }
  CHECK(jumps == std::vector<double>{5, -5, 5});
  CHECK(found.size() == Approx(7 / 0.12).margin(6));  // metres in all legs
}

TEST_CASE("Stops and cuts that a walk does not come by are refused") {
  Walk walk = straight_walk();
  walk.stops = {{15.5, 1}};
  CHECK(test::error_text([&] { poses(corridor_world(), walk); }).find("15.00 m long") !=
        std::string::npos);
  walk.stops = {{6, 1}, {4, 1}};
  CHECK(test::error_kind([&] { poses(corridor_world(), walk); }) == ErrorKind::usage);
  walk.stops.clear();
  walk.cuts = {{20, 3}};
  CHECK(test::error_text([&] { poses(corridor_world(), walk); }).find("a cut at 20 m") !=
        std::string::npos);
  walk.cuts = {{5, 40}};
  CHECK(test::error_kind([&] { poses(corridor_world(), walk); }) == ErrorKind::usage);
  walk.cuts.clear();
  walk.paces = {{0, 0.05}};
  walk.stops = {{1, 3600}, {2, 3600}, {3, 3600}};
  CHECK(test::error_text([&] { poses(corridor_world(), walk); }).find("at most 100000") !=
        std::string::npos);
}

TEST_CASE("Steps are as uneven as is asked for") {
  Walk walk = straight_walk();
  walk.frames = 101;
  const auto spread = [&](double unevenness) {
    walk.unevenness = unevenness;
    const auto found = poses(corridor_world(), walk);
    double least = 1, most = 0;
    for (size_t i = 1; i < found.size(); ++i) {
      least = std::min(least, step_m(found, i));
      most = std::max(most, step_m(found, i));
    }
    return most / least;
  };
  CHECK(spread(0) == Approx(1));
  CHECK(spread(0.15) > 1.2);
  CHECK(spread(0.15) < 1.4);
  CHECK(spread(0.5) > 1.8);
}
