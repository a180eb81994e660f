// Variation between parts of a building, days and walks: each setting changes only its own
// property; and textures.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "support.h"
#include "synth/recording.h"
#include "synth/scene.h"
#include "synth/surfaces.h"

using namespace vpr;
using namespace vpr::test;

namespace {

// The first seed with which no wall has windows.
uint64_t windowless_seed(World world) {
  const FloorPlan plan = make_floor_plan(world.floors[0]);
  const auto has_none = [&] {
    for (size_t i = 0; i < plan.walls.size(); ++i)
      if (!plan.walls[i].is_glass && has_windows(world, {"f", "f"}, plan, i)) return false;
    return true;
  };
  while (!has_none()) ++world.seed;
  return world.seed;
}

// A corridor with a glass front at its far right end, and a separate hall; no windows.
World two_rooms() {
  World world;
  world.name = "test";
  world.image_width = 96;
  world.image_height = 72;
  world.format = FrameFormat::png;
  Floor floor;
  floor.name = "f";
  floor.rooms = {{RoomKind::corridor, 0, 0, 12, 2.5}, {RoomKind::hall, 0, 6, 8, 5}};
  floor.glass = {{12, 0, 12, 2.5}};
  world.floors = {floor};
  Walk walk;
  walk.name = "w";
  walk.floor = "f";
  walk.path = {{1, 1.25}, {11, 1.25}};
  walk.frames = 9;
  world.walks = {walk};
  world.seed = windowless_seed(world);
  return world;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

bool same(const Texture& a, const Texture& b) { return same(a.levels[0], b.levels[0]); }

size_t changed_walls(const Scene& a, const Scene& b) {
  size_t changed = 0;
  for (size_t i = 0; i < a.walls.size(); ++i) changed += same(a.walls[i], b.walls[i]) ? 0 : 1;
  return changed;
}

Scene scene_of(const World& world, uint64_t day = 0) {
  return make_scene(world, 0, Monitor(), day);
}

CameraPose standing(double x, double y, double heading_deg) {
  CameraPose pose;
  pose.position = {x, y};
  pose.heading_deg = heading_deg;
  return pose;
}

cv::Mat picture(const World& world, const Scene& scene, const CameraPose& pose,
                const Conditions& conditions = {}, const std::vector<CameraPose>& metered = {}) {
  return render(make_camera(world), {scene, {}, {}, pose, conditions, metered},
                named_engine(1, "noise"));
}

double brightness(const cv::Mat& view) {
  const cv::Scalar mean = cv::mean(view);
  return (mean[0] + mean[1] + mean[2]) / 3;
}

// The maximum daylight in the wall that a ray hits.
int daylight_of(const Scene& scene, Point from, Point direction) {
  const cv::Mat& wall =
      scene.walls[static_cast<size_t>(cast_ray(scene.plan, from, direction)->wall)].levels[0];
  std::vector<cv::Mat> channels;
  cv::split(wall, channels);
  double most = 0;
  cv::minMaxLoc(channels[3], nullptr, &most);
  return static_cast<int>(most);
}

// Columns of 0, 10, 20, ... in all four channels, in the layout of a painted wall.
Texture ramp() {
  cv::Mat picture(4, 8, CV_8UC4);
  for (int x = 0; x < picture.cols; ++x) picture.col(x).setTo(cv::Scalar::all(10 * x));
  return make_wall_texture(picture);
}

}  // namespace

TEST_CASE("rooms differ in finish by the requested amount") {
  World world = two_rooms();
  const FloorNames names{"f", "f"};
  const auto tones = [&] {
    return std::pair(room_finish(world, names, 0).plaster[1],
                     room_finish(world, names, 1).plaster[1]);
  };
  CHECK(tones().first == tones().second);
  const Scene plain = scene_of(world);
  world.variety.finishes = 1;
  CHECK(tones().first != tones().second);
  const Scene varied = scene_of(world);
  CHECK_FALSE(same(plain.floor, varied.floor));
  CHECK_FALSE(same(plain.ceiling, varied.ceiling));
  CHECK(changed_walls(plain, varied) > plain.walls.size() / 2);
  CHECK(same(varied.floor, scene_of(world).floor));
}

TEST_CASE("renovated rooms differ from their twins in paint, flooring and lamps") {
  World world = two_rooms();
  world.variety.finishes = 1;
  world.floors[0].rooms[0].lamp_spacing_m = 12;  // one lamp; renovated rooms have 2 to 4.5 m
  Floor twin;
  twin.name = "g";
  twin.like = "f";
  twin.resemblance = 1;
  world.floors.push_back(twin);
  const Scene like = make_scene(world, 1, Monitor(), 0);
  world.floors[1].renovated = 1;
  const Scene renovated = make_scene(world, 1, Monitor(), 0);
  const auto lamps = [](const Scene& scene) {
    return std::ranges::count(scene.plan.lamps, size_t{0}, &Lamp::room);
  };
  CHECK(lamps(like) == 1);
  CHECK(lamps(renovated) >= 2);
  CHECK(changed_walls(like, renovated) > like.walls.size() / 2);
  CHECK_FALSE(same(like.floor, renovated.floor));
}

TEST_CASE("points belong to the hall if a hall and a corridor overlap") {
  Floor floor = two_rooms().floors[0];
  floor.rooms.push_back({RoomKind::corridor, 0, 0, 2.5, 11});
  CHECK(room_at(floor, {6, 1}) == 0);
  CHECK(room_at(floor, {1, 7}) == 1);
  CHECK(room_at(floor, {1, 4}) == 2);
}

TEST_CASE("bare walls have only doors, windows and fittings") {
  World world = two_rooms();
  const Scene furnished = scene_of(world);
  world.variety.bareness = 1;
  const Scene bare = scene_of(world);
  CHECK(changed_walls(furnished, bare) > 0);
  CHECK(same(furnished.floor, bare.floor));
  const auto detail = [](const Scene& scene) {
    double sum = 0;
    for (const Texture& wall : scene.walls) {
      cv::Mat slope;
      cv::Sobel(wall.levels[2], slope, CV_32F, 1, 0);
      sum += cv::norm(slope, cv::NORM_L1);
    }
    return sum;
  };
  CHECK(detail(bare) < 0.9 * detail(furnished));
}

TEST_CASE("wear marks walls but neither glass nor the floor") {
  World world = two_rooms();
  const Scene fresh = scene_of(world);
  world.variety.wear = 1;
  const Scene worn = scene_of(world);
  CHECK(same(fresh.floor, worn.floor));
  for (size_t i = 0; i < fresh.walls.size(); ++i)
    CHECK(same(fresh.walls[i], worn.walls[i]) == fresh.plan.walls[i].is_glass);
}

TEST_CASE("daylight enters through glass but not through walls") {
  World world = two_rooms();
  const auto across = [&](const Scene& scene) { return daylight_of(scene, {6, 1}, {0, 1}); };
  CHECK(across(scene_of(world)) == 0);
  world.variety.window_light = 1;
  const Scene daylit = scene_of(world);
  CHECK(across(daylit) > 20);
  CHECK(across(daylit) < kGlassDaylight);  // lit but not transparent
  CHECK(daylight_of(daylit, {4, 7}, {1, 0}) == 0);
  // Near the glass there is more daylight than at the other end.
  Conditions night;
  night.daylight = 0;
  const CameraPose near = standing(10.5, 1.25, 90), far = standing(2, 1.25, 90);
  const auto loss = [&](const CameraPose& pose) {
    return brightness(picture(world, daylit, pose, {}, {far})) -
           brightness(picture(world, daylit, pose, night, {far}));
  };
  CHECK(loss(near) > loss(far) + 5);
}

TEST_CASE("the distant outside has no parallax and is visible only through glass") {
  World world = two_rooms();
  const Scene near = scene_of(world);
  world.variety.far_view = 1;
  const Scene far = scene_of(world);
  Conditions quiet;
  quiet.noise = 0;
  const auto center = [&](const Scene& scene, double x) {  // with the same exposure for all x
    const cv::Mat view = picture(world, scene, standing(x, 1.5, 0), quiet, {standing(10, 1.5, 0)});
    return view(cv::Rect(view.cols / 2 - 1, view.rows / 2 - 1, 2, 2)).clone();
  };
  CHECK_FALSE(same(center(far, 9), center(near, 9)));
  CHECK(same(center(far, 9), center(far, 11)));
  CHECK_FALSE(same(picture(world, near, standing(10, 1.25, 0)),
                   picture(world, far, standing(10, 1.25, 0))));
  CHECK(same(picture(world, near, standing(10, 1.25, 180)),
             picture(world, far, standing(10, 1.25, 180))));
}

TEST_CASE("glass reflects the room and becomes brighter; nothing else changes") {
  World world = two_rooms();
  const Scene dull = scene_of(world);
  world.variety.reflections = 0.5;
  const Scene bright = scene_of(world);
  Conditions calm;
  calm.noise = 0;
  const auto gain = [&](double heading) {
    const CameraPose pose = standing(9, 1.25, heading);
    return picture(world, bright, pose, calm) - picture(world, dull, pose, calm);
  };
  CHECK(brightness(gain(0)) > 1);
  CHECK(brightness(gain(180)) == 0);
  const CameraPose pose = standing(9, 1.25, 0);
  CHECK(cv::countNonZero(
            cv::Mat(picture(world, dull, pose, calm) - picture(world, bright, pose, calm))
                .reshape(1)) == 0);
}

TEST_CASE("another day changes objects; the same day does not") {
  World world = two_rooms();
  CHECK(changed_walls(scene_of(world), scene_of(world, 1)) == 0);
  world.variety.changes = 1;
  const Scene before = scene_of(world), monday = scene_of(world, 1);
  CHECK(changed_walls(before, monday) > 0);
  CHECK(changed_walls(monday, scene_of(world, 1)) == 0);
  CHECK(changed_walls(monday, scene_of(world, 2)) > 0);
  CHECK(same(before.floor, monday.floor));
  CHECK(same(before.ceiling, monday.ceiling));
  world.variety.changes = 0;
  CHECK(changed_walls(before, scene_of(world, 1)) == 0);
}

TEST_CASE("the exposure lags behind the brightness") {
  const World world = two_rooms();
  const Scene scene = scene_of(world);
  const CameraPose glass = standing(11, 1.25, 0), wall = standing(6, 1.25, 180);
  const double own = brightness(picture(world, scene, wall));
  CHECK(brightness(picture(world, scene, wall, {}, {wall})) == own);
  const double after_glass = brightness(picture(world, scene, wall, {}, {glass}));
  const double between = brightness(picture(world, scene, wall, {}, {glass, wall}));
  CHECK(after_glass != Approx(own).margin(2));
  CHECK(between > std::min(own, after_glass));
  CHECK(between < std::max(own, after_glass));
}

TEST_CASE("a long shutter also blurs changes of pitch") {
  const World world = two_rooms();
  const Scene scene = scene_of(world);
  CameraPose pose = standing(6, 1.25, 90);
  pose.nod_deg_s = 150;
  Conditions calm;
  calm.noise = 0;
  const cv::Mat sharp = picture(world, scene, pose, calm);
  pose.nod_deg_s = 0;
  CHECK(same(sharp, picture(world, scene, pose, calm)));
  pose.nod_deg_s = 150;
  calm.shutter_s = 0.04;
  const auto edges = [](const cv::Mat& view, int dx) {
    cv::Mat slope;
    cv::Sobel(view, slope, CV_32F, dx, 1 - dx);
    return cv::norm(slope, cv::NORM_L1);
  };
  const cv::Mat blurred = picture(world, scene, pose, calm);
  CHECK(edges(blurred, 0) < 0.7 * edges(sharp, 0));
  CHECK(edges(blurred, 1) > 0.7 * edges(sharp, 1));
}

TEST_CASE("a recording with all settings on has the same bytes for any number of threads") {
  World world = two_rooms();
  world.variety = {1, 0.3, 1, 1, 1, 0.2, 0.5, 1};
  Walk& walk = world.walks[0];
  walk.day = 2;
  walk.crossing = 2;
  walk.ahead = 2;
  walk.jolt_deg = 1;
  walk.conditions.shutter_s = 0.03;
  world.places = {{"p", "f", 3, 1.25, {0}}};
  const auto bytes = [&](size_t threads) {
    const ThreadLimit limit(threads);
    const TemporaryFolder folder;
    write_recording(world, folder.path(), Monitor());
    std::string all;
    for (size_t i = 0; i < walk.frames; ++i)
      all += read_text(folder / ("w/0000" + std::to_string(i) + ".png"));
    return all + read_text(folder / "places/p/0.png");
  };
  const std::string one = bytes(1);
  CHECK(one.size() > 50'000);
  CHECK(one == bytes(3));
}

TEST_CASE("levels halve until a side is one texel long") {
  const Texture texture = ramp();
  REQUIRE(texture.levels.size() == 3);
  CHECK(texture.levels[0].rows == 8);  // transposed: a row is a vertical strip
  CHECK(texture.levels[0].cols == 4);
  CHECK(texture.levels[1].at<cv::Vec4b>(0, 0)[0] == 5);
  CHECK(texture.levels[2].at<cv::Vec4b>(1, 0)[0] == 55);
}

TEST_CASE("the chosen level has texels of about one pixel") {
  const Texture texture = ramp();
  CHECK(choose_level(texture, 0.1) == 0);
  CHECK(choose_level(texture, 1.4) == 0);
  CHECK(choose_level(texture, 2) == 1);
  CHECK(choose_level(texture, 1000) == 2);
}

TEST_CASE("a strip is the mean over the area of a pixel") {
  const Texture texture = ramp();
  std::vector<cv::Vec4b> strip;
  const auto value = [&](double center, double width, size_t level = 0) {
    filter_strip(texture, level, center, width, strip);
    CHECK(strip.size() == static_cast<size_t>(texture.levels[level].cols));
    return static_cast<int>(strip[0][0]);
  };
  CHECK(value(2.5, 0.1) == 20);  // the middle of texel 2
  CHECK(value(3.0, 0.1) == 25);  // between 2 and 3
  CHECK(value(4.0, 4.0) == 35);  // texels 2 to 5
  CHECK(value(0.0, 1.0) == 0);   // clamped at the end
  CHECK(value(99.0, 1.0) == 70);
  CHECK(value(1.0, 1.0, 1) == 5);
}

TEST_CASE("a panorama rotates with the direction of view") {
  const Texture panorama = make_panorama(1);
  const cv::Mat& strips = panorama.levels[0];
  const auto row_of = [&](Point direction) {
    std::vector<cv::Vec4b> strip;
    panorama_strip(panorama, direction, 1e-4, strip);
    for (int row = 0; row < strips.rows; ++row)
      if (std::equal(strip.begin(), strip.end(), strips.ptr<cv::Vec4b>(row))) return row;
    return -1;
  };
  const double step = 2 * 3.14159265358979 / strips.rows;
  const auto toward = [&](double steps) {
    return row_of({std::cos(steps * step), std::sin(steps * step)});
  };
  REQUIRE(toward(-100.5) >= 0);
  CHECK(toward(-100.5) >= toward(-0.5) + 90);
}
