#include "synth/wall_brush.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synth/texture.h"
#include "synth/world.h"

namespace vpr {
namespace {

std::string letters(RandomEngine& engine, size_t count) {
  std::string text;
  for (size_t i = 0; i < count; ++i)
    text += chance(engine, 0.17) ? ' ' : static_cast<char>('a' + uniform_below(engine, 26));
  return text;
}

}  // namespace

int wall_texels(double metres) { return static_cast<int>(std::lround(metres * kTexelsPerMetre)); }

bool chance(RandomEngine& engine, double probability) { return uniform_unit(engine) < probability; }

double between(RandomEngine& engine, double low, double high) {
  return low + (high - low) * uniform_unit(engine);
}

cv::Scalar colour(double blue, double green, double red) { return {blue, green, red, 0}; }

cv::Scalar any_colour(RandomEngine& engine, double low, double high) {
  const double blue = between(engine, low, high), green = between(engine, low, high);
  return colour(blue, green, between(engine, low, high));
}

cv::Scalar darker(const cv::Scalar& c, double factor) {
  return {c[0] * factor, c[1] * factor, c[2] * factor, c[3]};
}

cv::Rect WallBrush::area(double x, double bottom, double width, double height) const {
  const int top = wall_texels(kRoomHeightM - bottom - height);
  return {wall_texels(left_m + x), top, wall_texels(width),
          wall_texels(kRoomHeightM - bottom) - top};
}

void WallBrush::fill(double x, double bottom, double width, double height,
                     const cv::Scalar& paint) {
  const cv::Rect place = area(x, bottom, width, height);
  if (!place.empty()) cv::rectangle(picture, place, paint, cv::FILLED);
}

void WallBrush::fill_framed(double x, double bottom, double width, double height,
                            const cv::Scalar& inside, const cv::Scalar& frame, double frame_m) {
  const cv::Rect shadow =
      area(x + 0.02, bottom - 0.03, width, height) & cv::Rect(0, 0, picture.cols, picture.rows);
  if (!shadow.empty()) {
    cv::Mat part = picture(shadow);
    part.convertTo(part, -1, 0.7);
  }
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

}  // namespace vpr
