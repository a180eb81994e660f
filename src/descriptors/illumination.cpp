#include "descriptors/illumination.h"

#include <array>
#include <cassert>
#include <cmath>

#include <opencv2/core/mat.hpp>

namespace vpr {
namespace {

constexpr double kAlpha = 0.47;

std::array<double, 256> log_table() {
  std::array<double, 256> table{};
  for (size_t value = 1; value < table.size(); ++value)
    table[value] = std::log(static_cast<double>(value) / 255);
  return table;
}

uint8_t invariant_value(const cv::Vec3b& bgr, const std::array<double, 256>& ln) {
  double value = 0.5 + ln[bgr[1]] - kAlpha * ln[bgr[0]] - (1 - kAlpha) * ln[bgr[2]];
  if (value < 0) value = 1;
  return cv::saturate_cast<uint8_t>(std::nearbyint(value * 255));
}

}  // namespace

cv::Mat illumination_invariant(const cv::Mat& bgr) {
  assert(bgr.type() == CV_8UC3);
  static const std::array<double, 256> kLn = log_table();
  cv::Mat grey(bgr.size(), CV_8UC1);
  for (int y = 0; y < bgr.rows; ++y)
    for (int x = 0; x < bgr.cols; ++x)
      grey.at<uint8_t>(y, x) = invariant_value(bgr.at<cv::Vec3b>(y, x), kLn);
  return grey;
}

}  // namespace vpr
