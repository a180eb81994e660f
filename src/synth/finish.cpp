#include "synth/finish.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "synth/texture.h"

namespace vpr {

Finish building_finish(const World& world, const FloorNames& names) {
  RandomEngine engine = named_engine(world.seed, "building");
  RandomEngine own = named_engine(world.seed, "floor/" + names.plan);
  const double tone = between(engine, 165, 205) + between(own, -12, 12);
  Finish finish;
  const double warm = tone * between(engine, 0.98, 1.05);
  finish.plaster = colour(tone * between(engine, 0.86, 0.98), tone, warm);
  const double red = between(engine, 95, 150), green = between(engine, 100, 150);
  finish.dado = colour(between(engine, 90, 150), green, red);
  finish.dado_m = between(engine, 0.9, 1.2);
  finish.brick_halls = uniform_unit(own) < 0.5;
  return finish;
}

Finish room_finish(const World& world, const FloorNames& names, size_t room) {
  Finish finish = building_finish(world, names);
  const double variety = world.variety.finishes;
  if (variety == 0) return finish;
  RandomEngine engine = named_engine(world.seed, fmt::format("finish/{}/{}", names.plan, room));
  const auto factor = [&](double low, double high) {
    return 1 + variety * between(engine, low, high);
  };
  finish.plaster = darker(finish.plaster, factor(-0.45, 0.15));
  finish.plaster[0] *= factor(-0.15, 0.1);
  finish.plaster[2] *= factor(-0.15, 0.1);
  finish.dado = darker(finish.dado, factor(-0.6, 0.6));
  finish.dado_m = chance(engine, 0.4 * variety) ? 0 : finish.dado_m * factor(-0.4, 0.7);
  finish.flooring = factor(-0.6, 0.5);
  if (chance(engine, 0.6 * variety)) finish.flooring_tile_m = chance(engine, 0.5) ? 0.3 : 1.2;
  finish.has_runner = chance(engine, 0.4 * variety);
  finish.ceiling = factor(-0.55, 0.1);
  finish.has_slats = chance(engine, 0.4 * variety);
  finish.lamps = factor(-0.5, 0.4);
  if (chance(engine, 0.5 * variety)) finish.brick_halls = !finish.brick_halls;
  return finish;
}

size_t room_at(const Floor& floor, Point point) {
  size_t found = 0;
  bool in_room = false;
  for (size_t i = 0; i < floor.rooms.size(); ++i) {
    const Room& room = floor.rooms[i];
    const bool inside = point.x >= room.x && point.x < room.x + room.width && point.y >= room.y &&
                        point.y < room.y + room.depth;
    if (!inside || (in_room && room.kind != RoomKind::hall)) continue;
    found = i;
    in_room = true;
  }
  return found;
}

void lay_bricks(WallBrush& brush, double length_m) {
  constexpr double kBrick = 0.25, kCourse = 0.083, kJoint = 0.012;
  brush.fill(0, 0, length_m, kRoomHeightM, colour(140, 150, 155));
  int course = 0;
  for (double z = 0; z < kRoomHeightM; z += kCourse, ++course)
    for (double x = course % 2 == 0 ? 0 : -kBrick / 2; x < length_m; x += kBrick) {
      const double shade = between(brush.detail, 0.8, 1.15);
      brush.fill(x, z, kBrick - kJoint, kCourse - kJoint,
                 colour(62 * shade, 78 * shade, 140 * shade));
    }
}

void plaster(WallBrush& brush, const Finish& finish, double from_m, double to_m) {
  brush.fill(from_m, 0, to_m - from_m, kRoomHeightM, finish.plaster);
  if (finish.dado_m == 0) return;
  brush.fill(from_m, 0, to_m - from_m, finish.dado_m, finish.dado);
  brush.fill(from_m, finish.dado_m, to_m - from_m, 0.03, colour(70, 75, 80));
}

namespace {

// Smooth random values up to `most`, a new one every `texels`.
cv::Mat smooth_field(cv::Size size, int texels, double most, RandomEngine& engine) {
  cv::Mat small(size.height / texels + 2, size.width / texels + 2, CV_32F);
  for (int y = 0; y < small.rows; ++y)
    for (int x = 0; x < small.cols; ++x)
      small.at<float>(y, x) = static_cast<float>(between(engine, -most, most));
  cv::Mat field;
  cv::resize(small, field, size, 0, 0, cv::INTER_CUBIC);
  return field;
}

}  // namespace

void roughen(cv::Mat& picture, RandomEngine& engine, int fine, double coarse) {
  const cv::Mat stains = smooth_field(picture.size(), 48, coarse, engine);
  uint64_t bits = 0;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      if (x % 8 == 0) bits = engine();
      const int speckle = static_cast<int>(bits & 0xff) * (2 * fine + 1) / 256 - fine;
      bits >>= 8;
      const int change = speckle + static_cast<int>(std::lround(stains.at<float>(y, x)));
      for (int c = 0; c < 3; ++c) {
        uint8_t& value = picture.at<cv::Vec4b>(y, x)[c];
        value = cv::saturate_cast<uint8_t>(value + change);
      }
    }
}

void wear_wall(WallBrush& brush, double length_m, double wear, RandomEngine& engine) {
  if (wear == 0) return;
  cv::Mat& picture = brush.picture;
  const cv::Mat fading = smooth_field(picture.size(), wall_texels(1.3), 0.2 * wear, engine);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        uint8_t& value = picture.at<cv::Vec4b>(y, x)[c];
        value = cv::saturate_cast<uint8_t>(value * (1 + fading.at<float>(y, x)));
      }
  for (int i = 0; i < static_cast<int>(length_m * wear * 0.7); ++i) {  // mended
    const double x = between(engine, 0, length_m), z = between(engine, 0.1, 2.4);
    const double height = between(engine, 0.2, 0.9), width = between(engine, 0.3, 1.2);
    const cv::Rect patch =
        brush.area(x, z, width, height) & cv::Rect(0, 0, picture.cols, picture.rows);
    if (patch.empty()) continue;
    cv::Mat part = picture(patch);
    part.convertTo(part, -1, between(engine, 0.78, 1.15));
  }
  for (int i = 0; i < static_cast<int>(length_m * wear * 6); ++i) {  // scuffs
    const double shade = between(engine, 35, 110), z = between(engine, 0.1, 1.1);
    const double height = between(engine, 0.008, 0.03), width = between(engine, 0.03, 0.4);
    brush.fill(between(engine, 0, length_m), z, width, height, colour(shade, shade, shade));
  }
}

void lay_tiles(cv::Mat& picture, const cv::Rect& part, int texels, RandomEngine& engine,
               const cv::Scalar& base, double spread, const cv::Scalar& joint) {
  cv::Mat area = picture(part & cv::Rect(0, 0, picture.cols, picture.rows));
  for (int y = 0; y < area.rows; y += texels)
    for (int x = 0; x < area.cols; x += texels) {
      const double shade = 1 + between(engine, -spread, spread);
      cv::rectangle(area, cv::Rect(x, y, texels, texels), base * shade, cv::FILLED);
      cv::rectangle(area, cv::Rect(x, y, texels, texels), joint);
    }
}

}  // namespace vpr
