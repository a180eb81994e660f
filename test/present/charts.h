// Charts as text and as pixels.
#pragma once

#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "present/chart.h"
#include "support.h"

namespace vpr::test {

inline std::string svg_of(const Chart& chart) { return svg_file({chart}); }

inline cv::Mat pixels_of(const std::string& png) {
  return cv::imdecode(std::vector<uint8_t>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

inline size_t count_of(const cv::Mat& image, Meaning meaning) {
  cv::Mat found;
  cv::inRange(image, cv::Scalar(bgr_of(meaning)), cv::Scalar(bgr_of(meaning)), found);
  return static_cast<size_t>(cv::countNonZero(found));
}

}  // namespace vpr::test
