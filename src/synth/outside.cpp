#include "synth/outside.h"

#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "synth/wall_brush.h"

namespace vpr {
namespace {

constexpr int kAround = 4096;  // texels
constexpr int kHigh = 1024;    // for tangents from 1 to -1
constexpr int kHorizon = kHigh / 2;
constexpr double kOpen = 255;  // daylight share of what is outside

cv::Scalar shine(double blue, double green, double red) { return {blue, green, red, kOpen}; }

void paint_house(cv::Mat& picture, RandomEngine& engine) {
  const int left = static_cast<int>(uniform_below(engine, kAround));
  const int width = static_cast<int>(between(engine, 120, 420));
  const int height = static_cast<int>(between(engine, 40, 190));
  const double tone = between(engine, 70, 200);
  const cv::Scalar front = shine(tone * between(engine, 0.8, 1), tone * 0.97, tone);
  cv::rectangle(picture, cv::Rect(left, kHorizon - height, width, height + 30), front, cv::FILLED);
  const double dark = between(engine, 0.35, 0.7);
  for (int y = kHorizon - height + 12; y < kHorizon; y += 26)
    for (int x = left + 10; x + 12 < left + width; x += 24)
      cv::rectangle(picture, cv::Rect(x, y, 12, 15),
                    shine(front[0] * dark, front[1] * dark, front[2] * dark), cv::FILLED);
}

void paint_tree(cv::Mat& picture, RandomEngine& engine) {
  const int x = static_cast<int>(uniform_below(engine, kAround));
  const int size = static_cast<int>(between(engine, 20, 85));
  for (int i = 0; i < 14; ++i) {
    const double shade = between(engine, 50, 130);
    const int up = static_cast<int>(between(engine, 0, size));
    const int aside = static_cast<int>(between(engine, -size, size));
    const cv::Point leaf(x + aside, kHorizon - size / 2 - up);
    cv::circle(picture, leaf, size / 3 + 2, shine(shade * 0.55, shade, shade * 0.75), cv::FILLED);
  }
}

}  // namespace

Texture make_panorama(uint64_t seed) {
  RandomEngine engine = named_engine(seed, "outside");
  cv::Mat picture(kHigh, kAround, CV_8UC4);
  for (int y = 0; y < kHigh; ++y) {
    const double up = static_cast<double>(kHorizon - y) / kHorizon;
    picture.row(y).setTo(up > 0 ? shine(250 - 20 * up, 240 - 45 * up, 232 - 80 * up)
                                : shine(95 + 30 * up, 125 + 30 * up, 118 + 30 * up));
  }
  for (int i = 0; i < 16; ++i) {  // clouds
    const int down = static_cast<int>(between(engine, 0, 0.6 * kHorizon));
    const cv::Point middle(static_cast<int>(uniform_below(engine, kAround)), down);
    cv::ellipse(
        picture, middle,
        {static_cast<int>(between(engine, 80, 300)), static_cast<int>(between(engine, 15, 50))}, 0,
        0, 360, shine(246, 244, 240), cv::FILLED, cv::LINE_AA);
  }
  for (int i = 0; i < 20; ++i) paint_house(picture, engine);
  for (int i = 0; i < 40; ++i) paint_tree(picture, engine);
  return make_wall_texture(picture);
}

void panorama_strip(const Texture& panorama, Point direction, double pixel_rad,
                    std::vector<cv::Vec4b>& strip) {
  const double turn = std::atan2(direction.y, direction.x) / (2 * std::numbers::pi);
  const double texels = pixel_rad / (2 * std::numbers::pi) * kAround;
  // Clockwise, as one sees it who turns to the right.
  filter_strip(panorama, choose_level(panorama, texels), (0.5 - turn) * kAround,
               std::max(1.0, texels), strip);
}

}  // namespace vpr
