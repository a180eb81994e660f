#include "synth/people.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

using namespace vpr;

namespace {

struct Scenery {
  World world;
  FloorPlan plan;
  std::vector<CameraPose> poses;

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
  }
  std::vector<Figure> at(const CameraPose& pose) const {
    return Crowd(world, world.walks[0], plan, poses, 14).at(pose.time_s);
  }
};

Walk with(uint64_t Walk::*who, uint64_t groups) {
  Walk walk;
  walk.*who = groups;
  return walk;
}

}  // namespace

TEST_CASE("Nobody is there who was not asked for") {
  const Scenery empty{Walk()};
  for (const CameraPose& pose : empty.poses) CHECK(empty.at(pose).empty());
}

TEST_CASE("People walk ahead of the camera for a while, in its way") {
  const Scenery scenery(with(&Walk::ahead, 1));
  size_t seen = 0;
  double most = 0;
  for (const CameraPose& pose : scenery.poses)
    for (const Figure& figure : scenery.at(pose)) {
      const double ahead = figure.position.x - pose.position.x;
      CHECK(ahead > 1);
      most = std::max(most, ahead);
      CHECK(std::abs(figure.position.y - 1.5) <= 1.5);
      ++seen;
    }
  CHECK(seen >= 10);
  CHECK(most < 4 + 0.3 + 20 * 0.15);
}

TEST_CASE("People cross the way from one side to the other, in front of the camera") {
  const Scenery scenery(with(&Walk::crossing, 1));
  std::vector<double> sideways, ahead;
  for (const CameraPose& pose : scenery.poses) {
    const std::vector<Figure> figures = scenery.at(pose);
    if (figures.empty()) continue;
    sideways.push_back(figures[0].position.y - 1.5);
    if (std::abs(sideways.back()) < 0.2) ahead.push_back(figures[0].position.x - pose.position.x);
  }
  REQUIRE_FALSE(sideways.empty());
  CHECK(std::abs(sideways.front() - sideways.back()) > 2);  // from wall to wall
  CHECK((std::is_sorted(sideways.begin(), sideways.end()) ||
         std::is_sorted(sideways.rbegin(), sideways.rend())));
  REQUIRE_FALSE(ahead.empty());
  for (const double metres : ahead) {
    CHECK(metres > 0.7);
    CHECK(metres < 4.5);
  }
}
