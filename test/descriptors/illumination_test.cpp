#include "descriptors/illumination.h"

#include <cmath>

#include <catch2/catch.hpp>
#include <opencv2/core/mat.hpp>

using namespace vpr;

namespace {

int invariant(int b, int g, int r) {
  return illumination_invariant(cv::Mat(1, 1, CV_8UC3, cv::Scalar(b, g, r))).at<uint8_t>(0, 0);
}

}  // namespace

TEST_CASE("illumination invariance follows its formula, worked out by hand") {
  CHECK(invariant(128, 128, 128) == 128);  // 0.5 * 255 = 127.5, to the even neighbour
  // 0.5 + ln(100/255) - 0.47 ln(50/255) - 0.53 ln(200/255) = 0.4584; times 255 = 116.9
  CHECK(invariant(50, 100, 200) == 117);
}

TEST_CASE("grey of any brightness gives the same value") {
  for (int grey = 1; grey < 256; grey += 13)
    CHECK(std::abs(invariant(grey, grey, grey) - 127.5) < 1);
}

TEST_CASE("the logarithm of zero counts as zero, and values below zero become one") {
  CHECK(invariant(0, 0, 0) == 128);
  CHECK(invariant(255, 1, 255) == 255);  // 0.5 + ln(1/255) < 0
  CHECK(invariant(1, 255, 255) == 255);  // saturated
}
