#include "synth/surfaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "synth/world.h"

namespace vpr {
namespace {

std::string letters(RandomEngine& engine, size_t count) {
  std::string text;
  for (size_t i = 0; i < count; ++i)
    text += chance(engine, 0.17) ? ' ' : static_cast<char>('a' + uniform_below(engine, 26));
  return text;
}

// Smooth random values up to `most`, with one independent value every `texels`.
cv::Mat smooth_field(cv::Size size, int texels, double most, RandomEngine& engine) {
  cv::Mat small(size.height / texels + 2, size.width / texels + 2, CV_32F);
  for (int y = 0; y < small.rows; ++y)
    for (int x = 0; x < small.cols; ++x)
      small.at<float>(y, x) = static_cast<float>(between(engine, -most, most));
  cv::Mat field;
  cv::resize(small, field, size, 0, 0, cv::INTER_CUBIC);
  return field;
}

constexpr int kAround = 4096;  // texels
constexpr int kHigh = 1024;    // for tangents from 1 to -1
constexpr int kHorizon = kHigh / 2;

void paint_house(cv::Mat& picture, RandomEngine& engine) {
  const int left = static_cast<int>(uniform_below(engine, kAround));
  const int width = static_cast<int>(between(engine, 120, 420));
  const int height = static_cast<int>(between(engine, 40, 190));
  const double tone = between(engine, 70, 200);
  const cv::Scalar front = opaque(tone * between(engine, 0.8, 1), tone * 0.97, tone);
  cv::rectangle(picture, cv::Rect(left, kHorizon - height, width, height + 30), front, cv::FILLED);
  const double dark = between(engine, 0.35, 0.7);
  for (int y = kHorizon - height + 12; y < kHorizon; y += 26)
    for (int x = left + 10; x + 12 < left + width; x += 24)
      cv::rectangle(picture, cv::Rect(x, y, 12, 15), darker(front, dark), cv::FILLED);
}

void paint_tree(cv::Mat& picture, RandomEngine& engine) {
  const int x = static_cast<int>(uniform_below(engine, kAround));
  const int size = static_cast<int>(between(engine, 20, 85));
  for (int i = 0; i < 14; ++i) {
    const double shade = between(engine, 50, 130);
    const int up = static_cast<int>(between(engine, 0, size));
    const int aside = static_cast<int>(between(engine, -size, size));
    const cv::Point leaf(x + aside, kHorizon - size / 2 - up);
    cv::circle(picture, leaf, size / 3 + 2, opaque(shade * 0.55, shade, shade * 0.75), cv::FILLED);
  }
}

}  // namespace

Texture make_texture(const cv::Mat& level_0) {
  Texture texture;
  texture.levels.push_back(level_0);
  while (true) {
    const cv::Mat& last = texture.levels.back();
    if (last.rows < 2 || last.cols < 2) return texture;
    cv::Mat half;
    cv::resize(last, half, {last.cols / 2, last.rows / 2}, 0, 0, cv::INTER_AREA);
    texture.levels.push_back(half);
  }
}

Texture make_wall_texture(const cv::Mat& picture) {
  cv::Mat turned;
  cv::transpose(picture, turned);
  return make_texture(turned);
}

size_t choose_level(const Texture& texture, double texels) {
  size_t level = 0;
  while (level + 1 < texture.levels.size() && texels > 1.4) {
    texels /= 2;
    ++level;
  }
  return level;
}

void filter_strip(const Texture& texture, size_t level, double center, double width,
                  std::vector<cv::Vec4b>& strip) {
  // limit for a wall seen almost edge-on: one pixel, a few strips
  constexpr double kMaxTexels = 24;
  const cv::Mat& image = texture.levels[level];
  const double scale = static_cast<double>(image.rows) / texture.levels[0].rows;
  const double extent = std::clamp(width * scale, 1.0, kMaxTexels);
  const double low = std::clamp(center * scale - extent / 2, -1e6, 1e6);
  const int first = static_cast<int>(std::floor(low));
  const int last = static_cast<int>(std::ceil(low + extent)) - 1;
  const auto pixels = static_cast<size_t>(image.cols);
  thread_local std::vector<uint32_t> sums;
  sums.assign(pixels * 4, 0);
  uint32_t weights = 0;
  for (int row = first; row <= last; ++row) {
    const double covered = std::min(row + 1.0, low + extent) - std::max<double>(row, low);
    const auto weight = static_cast<uint32_t>(std::lround(covered * 256));
    const uint8_t* texels = image.ptr<uint8_t>(std::clamp(row, 0, image.rows - 1));
    for (size_t i = 0; i < pixels * 4; ++i) sums[i] += weight * texels[i];
    weights += weight;
  }
  strip.resize(pixels);
  const uint32_t factor = (1u << 24) / weights;  // at most 24 * 256 * 255 * factor: below 2^32
  auto* bytes = reinterpret_cast<uint8_t*>(strip.data());
  for (size_t i = 0; i < pixels * 4; ++i)
    bytes[i] = static_cast<uint8_t>((sums[i] * factor + (1u << 23)) >> 24);
}

Texture make_panorama(uint64_t seed) {
  RandomEngine engine = named_engine(seed, "outside");
  cv::Mat picture(kHigh, kAround, CV_8UC4);
  for (int y = 0; y < kHigh; ++y) {
    const double up = static_cast<double>(kHorizon - y) / kHorizon;
    picture.row(y).setTo(up > 0 ? opaque(250 - 20 * up, 240 - 45 * up, 232 - 80 * up)
                                : opaque(95 + 30 * up, 125 + 30 * up, 118 + 30 * up));
  }
  for (int i = 0; i < 16; ++i) {  // clouds
    const int down = static_cast<int>(between(engine, 0, 0.6 * kHorizon));
    const cv::Point middle(static_cast<int>(uniform_below(engine, kAround)), down);
    cv::ellipse(
        picture, middle,
        {static_cast<int>(between(engine, 80, 300)), static_cast<int>(between(engine, 15, 50))}, 0,
        0, 360, opaque(246, 244, 240), cv::FILLED, cv::LINE_AA);
  }
  for (int i = 0; i < 20; ++i) paint_house(picture, engine);
  for (int i = 0; i < 40; ++i) paint_tree(picture, engine);
  return make_wall_texture(picture);
}

void panorama_strip(const Texture& panorama, Point direction, double pixel_rad,
                    std::vector<cv::Vec4b>& strip) {
  const double turn = std::atan2(direction.y, direction.x) / (2 * std::numbers::pi);
  const double texels = pixel_rad / (2 * std::numbers::pi) * kAround;
  // Clockwise, in the direction of a turn to the right.
  filter_strip(panorama, choose_level(panorama, texels), (0.5 - turn) * kAround,
               std::max(1.0, texels), strip);
}

int wall_texels(double meters) { return static_cast<int>(std::lround(meters * kTexelsPerMeter)); }

bool chance(RandomEngine& engine, double probability) { return uniform_unit(engine) < probability; }

double between(RandomEngine& engine, double low, double high) {
  return low + (high - low) * uniform_unit(engine);
}

cv::Scalar color(double blue, double green, double red) { return {blue, green, red, 0}; }

cv::Scalar opaque(double blue, double green, double red) { return {blue, green, red, 255}; }

cv::Scalar any_color(RandomEngine& engine, double low, double high) {
  const double blue = between(engine, low, high), green = between(engine, low, high);
  return color(blue, green, between(engine, low, high));
}

cv::Scalar darker(const cv::Scalar& c, double factor) {
  return {c[0] * factor, c[1] * factor, c[2] * factor, c[3]};
}

cv::Rect WallBrush::area(double x, double bottom, double width, double height) const {
  const int top = wall_texels(kRoomHeightM - bottom - height);
  return {wall_texels(left_m + x), top, wall_texels(width),
          wall_texels(kRoomHeightM - bottom) - top};
}

cv::Mat WallBrush::part(double x, double bottom, double width, double height) const {
  return picture(area(x, bottom, width, height) & cv::Rect({}, picture.size()));
}

void WallBrush::fill(double x, double bottom, double width, double height,
                     const cv::Scalar& paint) {
  const cv::Rect place = area(x, bottom, width, height);
  if (!place.empty()) cv::rectangle(picture, place, paint, cv::FILLED);
}

void WallBrush::fill_framed(double x, double bottom, double width, double height,
                            const cv::Scalar& inside, const cv::Scalar& frame, double frame_m) {
  cv::Mat shadow = part(x + 0.02, bottom - 0.03, width, height);
  if (!shadow.empty()) shadow.convertTo(shadow, -1, 0.7);
  fill(x, bottom, width, height, frame);
  fill(x + frame_m, bottom + frame_m, width - 2 * frame_m, height - 2 * frame_m, inside);
}

void WallBrush::put_text(double x, double bottom, double height, const std::string& text,
                         const cv::Scalar& ink, int thickness) {
  const cv::Rect place = area(x, bottom, 0, height);
  // Hershey's simplex letters are 21 units high at scale 1.
  cv::putText(picture, text, {place.x, place.y + place.height}, cv::FONT_HERSHEY_SIMPLEX,
              place.height / 21.0, ink, thickness, cv::LINE_AA);
}

void WallBrush::write(double x, double bottom, double width, double height, double line_m,
                      const cv::Scalar& ink) {
  const double letter = line_m * 0.55;
  const auto count = static_cast<size_t>(std::max(0.0, width / (letter * 0.85)));
  if (count == 0) return;
  for (double y = bottom + height - letter; y >= bottom; y -= line_m) {
    const size_t length = std::min<size_t>(count, 1 + uniform_below(detail, count + count / 2 + 1));
    put_text(x, y, letter, letters(detail, length), ink, line_m > 0.08 ? 2 : 1);
  }
}

Finish room_finish(const World& world, const FloorNames& names, size_t room) {
  RandomEngine building = named_engine(world.seed, "building");
  RandomEngine own = named_engine(world.seed, "floor/" + names.plan);
  const double tone = between(building, 165, 205) + between(own, -12, 12);
  Finish finish;
  const double warm = tone * between(building, 0.98, 1.05);
  finish.plaster = color(tone * between(building, 0.86, 0.98), tone, warm);
  const double red = between(building, 95, 150), green = between(building, 100, 150);
  finish.dado = color(between(building, 90, 150), green, red);
  finish.dado_m = between(building, 0.9, 1.2);
  finish.brick_halls = uniform_unit(own) < 0.5;
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
    if (!room.contains(point.x, point.y) || (in_room && room.kind != RoomKind::hall)) continue;
    found = i;
    in_room = true;
  }
  return found;
}

void lay_bricks(WallBrush& brush, double length_m) {
  constexpr double kBrick = 0.25, kCourse = 0.083, kJoint = 0.012;
  brush.fill(0, 0, length_m, kRoomHeightM, color(140, 150, 155));
  int course = 0;
  for (double z = 0; z < kRoomHeightM; z += kCourse, ++course)
    for (double x = course % 2 == 0 ? 0 : -kBrick / 2; x < length_m; x += kBrick) {
      const double shade = between(brush.detail, 0.8, 1.15);
      brush.fill(x, z, kBrick - kJoint, kCourse - kJoint,
                 color(62 * shade, 78 * shade, 140 * shade));
    }
}

void plaster(WallBrush& brush, const Finish& finish, double from_m, double to_m) {
  brush.fill(from_m, 0, to_m - from_m, kRoomHeightM, finish.plaster);
  if (finish.dado_m == 0) return;
  brush.fill(from_m, 0, to_m - from_m, finish.dado_m, finish.dado);
  brush.fill(from_m, finish.dado_m, to_m - from_m, 0.03, color(70, 75, 80));
}

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
  for (int i = 0; i < static_cast<int>(length_m * wear * 0.7); ++i) {  // repairs
    const double x = between(engine, 0, length_m), z = between(engine, 0.1, 2.4);
    const double height = between(engine, 0.2, 0.9), width = between(engine, 0.3, 1.2);
    cv::Mat patch = brush.part(x, z, width, height);
    if (!patch.empty()) patch.convertTo(patch, -1, between(engine, 0.78, 1.15));
  }
  for (int i = 0; i < static_cast<int>(length_m * wear * 6); ++i) {  // scuffs
    const double shade = between(engine, 35, 110), z = between(engine, 0.1, 1.1);
    const double height = between(engine, 0.008, 0.03), width = between(engine, 0.03, 0.4);
    brush.fill(between(engine, 0, length_m), z, width, height, color(shade, shade, shade));
  }
}

void lay_tiles(cv::Mat& picture, const cv::Rect& part, int texels, RandomEngine& engine,
               const cv::Scalar& base, double spread, const cv::Scalar& joint) {
  cv::Mat area = picture(part & cv::Rect({}, picture.size()));
  for (int y = 0; y < area.rows; y += texels)
    for (int x = 0; x < area.cols; x += texels) {
      const double shade = 1 + between(engine, -spread, spread);
      cv::rectangle(area, cv::Rect(x, y, texels, texels), base * shade, cv::FILLED);
      cv::rectangle(area, cv::Rect(x, y, texels, texels), joint);
    }
}

}  // namespace vpr
