#include "report/framed_picture.h"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace vpr {
namespace {

constexpr int kLeft = 70;
constexpr int kTop = 48;
constexpr int kRight = 40;
constexpr int kLine = 24;  // of text
constexpr int kLeastWidth = 560;
constexpr size_t kMostTicks = 8;
const cv::Scalar kInk(60, 50, 40);

int width_of(const std::string& text) {
  int below = 0;
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 0.45, 1, &below).width;
}

void write(cv::Mat& canvas, const std::string& text, int x, int y) {
  cv::putText(canvas, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.45, kInk, 1, cv::LINE_AA);
}

void draw_axes(cv::Mat& canvas, const cv::Size& size, const PictureFrame& frame) {
  const auto at = [&](double position) { return static_cast<int>(position * frame.pixels); };
  for (const AxisTick& tick : ticks_of(frame.rows, kMostTicks)) {
    const int y = kTop + at(tick.position);
    const std::string text = std::to_string(tick.frame);
    cv::line(canvas, {kLeft - 5, y}, {kLeft - 1, y}, kInk);
    write(canvas, text, kLeft - 9 - width_of(text), y + 5);
  }
  for (const AxisTick& tick : ticks_of(frame.columns, kMostTicks)) {
    const int x = kLeft + at(tick.position);
    const std::string text = std::to_string(tick.frame);
    cv::line(canvas, {x, kTop + size.height}, {x, kTop + size.height + 4}, kInk);
    write(canvas, text, x - width_of(text) / 2, kTop + size.height + 18);
  }
  int named_until = 0;
  for (const FrameBand& band : frame.columns) {
    const int x = kLeft + at(static_cast<double>(band.at));
    if (x < named_until) continue;
    write(canvas, band.name, x, kTop - 8);
    named_until = x + width_of(band.name) + 8;
  }
  write(canvas, "query frame, downwards", 8, 18);
  write(canvas, "training frame", kLeft, kTop + size.height + 18 + kLine);
}

void draw_legend(cv::Mat& canvas, const PictureFrame& frame, int y) {
  int x = kLeft;
  for (const Meaning meaning : frame.shown) {
    const std::string words(colour_of(meaning).words);
    cv::rectangle(canvas, cv::Rect(x, y - 11, 12, 12), bgr_of(meaning), cv::FILLED);
    write(canvas, words, x + 18, y);
    x += width_of(words) + 38;
  }
}

void draw_greys(cv::Mat& canvas, const PictureFrame& frame, int y) {
  constexpr int kWidth = 256;
  const std::string black = fmt::format("{:.6g}", frame.greys->first);
  const int left = kLeft + width_of(black) + 8;
  write(canvas, black, kLeft, y);
  for (int x = 0; x < kWidth; ++x)
    cv::line(canvas, {left + x, y - 11}, {left + x, y}, cv::Scalar::all(x));
  write(canvas, fmt::format("{:.6g}   {}", frame.greys->second, frame.grey_words),
        left + kWidth + 8, y);
}

}  // namespace

cv::Mat framed(const cv::Mat& image, const PictureFrame& frame) {
  const int lines = 2 + (frame.shown.empty() ? 0 : 1) + (frame.greys ? 1 : 0);
  cv::Mat canvas(kTop + image.rows + lines * kLine + 8,
                 std::max(kLeft + image.cols + kRight, kLeastWidth), CV_8UC3, cv::Scalar::all(255));
  image.copyTo(canvas(cv::Rect(kLeft, kTop, image.cols, image.rows)));
  cv::rectangle(canvas, cv::Rect(kLeft - 1, kTop - 1, image.cols + 2, image.rows + 2), kInk);
  draw_axes(canvas, image.size(), frame);
  int y = kTop + image.rows + 18 + 2 * kLine;
  if (!frame.shown.empty()) draw_legend(canvas, frame, y);
  if (!frame.shown.empty()) y += kLine;
  if (frame.greys) draw_greys(canvas, frame, y);
  return canvas;
}

}  // namespace vpr
