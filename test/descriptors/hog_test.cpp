#include "descriptors/hog.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>

using namespace vpr;

namespace {

// A block in the middle of the picture, without the Gaussian weights and the sharing between cells:
// where the gradient is the same everywhere, only directions matter. Of 8 over half a turn.
int strongest_direction(const std::vector<int8_t>& descriptor) {
  const auto block = descriptor.begin() + (15 * 31 + 15) * 32;
  return static_cast<int>(std::max_element(block, block + 8) - block);
}

cv::Mat ramp(double degrees) {
  cv::Mat picture(512, 512, CV_8U);
  const double across = std::cos(degrees * CV_PI / 180);
  const double down = std::sin(degrees * CV_PI / 180);
  for (int y = 0; y < 512; ++y)
    for (int x = 0; x < 512; ++x)
      picture.at<uint8_t>(y, x) =
          static_cast<uint8_t>(std::lround(127 + 60 * std::sin((x * across + y * down) / 12)));
  return picture;
}

}  // namespace

TEST_CASE("histograms of gradients have the direction of the picture's") {
  CHECK(describe_hog(ramp(0)).size() == kHogLength);
  for (int bin = 0; bin < 8; ++bin) {
    const int found = strongest_direction(describe_hog(ramp((bin + 0.5) * 22.5)));
    INFO("direction " << bin);
    CHECK(found == bin);
  }
}

TEST_CASE("light does not count, and nothing gives nothing") {
  const cv::Mat picture = ramp(30);
  cv::Mat brighter;
  picture.convertTo(brighter, CV_8U, 1, 40);
  CHECK(describe_hog(picture) == describe_hog(brighter));
  const std::vector<int8_t> flat = describe_hog(cv::Mat(120, 160, CV_8U, cv::Scalar(90)));
  CHECK(flat == std::vector<int8_t>(kHogLength, 0));
}
