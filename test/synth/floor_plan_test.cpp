#include "synth/floor_plan.h"

#include <cmath>

#include <catch2/catch.hpp>

using namespace vpr;

namespace {

// A corridor 10 m long and 2 m deep, with a pillar and a glass front at its right end.
Floor corridor() {
  Floor floor;
  floor.name = "f";
  floor.rooms = {{RoomKind::corridor, 0, 0, 10, 2}};
  floor.pillars = {{6, 0}};
  floor.glass = {{10, 0, 10, 2}};
  return floor;
}

const Wall& wall_of(const FloorPlan& plan, const WallHit& hit) {
  return plan.walls[static_cast<size_t>(hit.wall)];
}

}  // namespace

TEST_CASE("rays hit the walls of a corridor at the expected points") {
  const FloorPlan plan = make_floor_plan(corridor());
  const auto up = cast_ray(plan, {3, 1}, {0, 1});
  REQUIRE(up);
  CHECK(up->distance == Approx(1));
  CHECK(up->along_m == Approx(3));  // the left end of the upper wall is at x 0, seen from below
  CHECK(wall_of(plan, *up).length_m == Approx(10));
  const auto down = cast_ray(plan, {3, 1}, {0, -1});
  REQUIRE(down);
  // Seen from the room, the lower wall begins on the right, at the pillar's left edge (x 6).
  CHECK(wall_of(plan, *down).length_m == Approx(6));
  CHECK(down->along_m == Approx(3));
  const auto right = cast_ray(plan, {3, 1}, {2, 0});
  REQUIRE(right);
  CHECK(right->distance == Approx(3.5));  // in units of the direction's length
  CHECK(wall_of(plan, *right).is_glass);
  CHECK(right->along_m == Approx(1));
  const auto pillar = cast_ray(plan, {3, 0.25}, {1, 0});
  REQUIRE(pillar);
  CHECK(pillar->distance == Approx(3));
  CHECK(wall_of(plan, *pillar).is_pillar);
  CHECK_FALSE(cast_ray(plan, {-5, 1}, {1, 0}));
}

TEST_CASE("every face of an open cell belongs to exactly one wall") {
  Floor floor = corridor();
  floor.rooms.push_back({RoomKind::hall, 4, 2, 3, 5});
  const FloorPlan plan = make_floor_plan(floor);
  double faces = 0, walls = 0;
  for (const int32_t wall : plan.wall_of) faces += wall >= 0 ? kPlanCellM : 0;
  for (const Wall& wall : plan.walls) walls += wall.length_m;
  CHECK(faces == Approx(walls));
  // The outline is 2 * (10 + 2), the hall adds 2 * 5, and three sides of the pillar replace one.
  CHECK(walls == Approx(24 + 10 + 1));
}

TEST_CASE("there is no wall between rooms that touch") {
  Floor floor;
  floor.rooms = {{RoomKind::corridor, 0, 0, 4, 2}, {RoomKind::corridor, 4, 0, 4, 2}};
  const auto hit = cast_ray(make_floor_plan(floor), {1, 1}, {1, 0});
  REQUIRE(hit);
  CHECK(hit->distance == Approx(7));
}

TEST_CASE("slanted rays agree with small steps along them") {
  Floor floor = corridor();
  floor.rooms.push_back({RoomKind::hall, 4, 2, 3, 5});
  const FloorPlan plan = make_floor_plan(floor);
  for (int degrees = 1; degrees < 360; degrees += 7) {
    const double angle = degrees * 3.14159265358979 / 180;
    const Point direction{std::cos(angle), std::sin(angle)};
    const auto hit = cast_ray(plan, {5.1, 3.3}, direction);
    REQUIRE(hit);
    double walked = 0;
    while (plan.is_open({5.1 + walked * direction.x, 3.3 + walked * direction.y})) walked += 0.001;
    CHECK(hit->distance == Approx(walked).margin(0.002));
  }
}

TEST_CASE("distances are rounded the same way on every processor") {
  // std::hypot(0.1, 0.1) ends in 0a on x86 and in 0b on ARM.
  for (int x = 1; x < 100; ++x)
    for (int y = 1; y < 100; ++y)
      REQUIRE(distance({0, 0}, {0.1 * x, 0.1 * y}) ==
              std::sqrt(0.1 * x * (0.1 * x) + 0.1 * y * (0.1 * y)));
}

TEST_CASE("points see each other unless there is a wall between them") {
  const FloorPlan plan = make_floor_plan(corridor());
  CHECK(can_see(plan, {1, 1}, {9, 1}));
  CHECK_FALSE(can_see(plan, {1, 0.25}, {9, 0.25}));  // the pillar
  CHECK_FALSE(can_see(plan, {1, 1}, {1, 3}));
}

TEST_CASE("each room sets the distance between its lamps") {
  Floor floor = corridor();
  const auto lamps = [&] { return make_floor_plan(floor).lamps.size(); };
  CHECK(lamps() == 3);  // 10 m, with the default of 3 m between two lamps
  floor.rooms[0].lamp_spacing_m = 1.25;
  CHECK(lamps() == 8);
}
