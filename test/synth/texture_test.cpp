#include "synth/texture.h"

#include <catch2/catch.hpp>
#include <opencv2/core/mat.hpp>

using namespace vpr;

namespace {

// Columns of 0, 10, 20, ... in all four channels, as a wall is painted.
Texture ramp() {
  cv::Mat picture(4, 8, CV_8UC4);
  for (int x = 0; x < picture.cols; ++x) picture.col(x).setTo(cv::Scalar::all(10 * x));
  return make_wall_texture(picture);
}

}  // namespace

TEST_CASE("levels halve until a side is one texel long") {
  const Texture texture = ramp();
  REQUIRE(texture.levels.size() == 3);
  CHECK(texture.levels[0].rows == 8);  // turned: a row is a vertical strip
  CHECK(texture.levels[0].cols == 4);
  CHECK(texture.levels[1].at<cv::Vec4b>(0, 0)[0] == 5);
  CHECK(texture.levels[2].at<cv::Vec4b>(1, 0)[0] == 55);
}

TEST_CASE("a level is chosen at which a texel is about a pixel") {
  const Texture texture = ramp();
  CHECK(choose_level(texture, 0.1) == 0);
  CHECK(choose_level(texture, 1.4) == 0);
  CHECK(choose_level(texture, 2) == 1);
  CHECK(choose_level(texture, 1000) == 2);
}

TEST_CASE("a strip is the mean of what a pixel covers") {
  const Texture texture = ramp();
  std::vector<cv::Vec4b> strip;
  const auto value = [&](double centre, double width, size_t level = 0) {
    filter_strip(texture, level, centre, width, strip);
    CHECK(strip.size() == static_cast<size_t>(texture.levels[level].cols));
    return static_cast<int>(strip[0][0]);
  };
  CHECK(value(2.5, 0.1) == 20);  // the middle of texel 2
  CHECK(value(3.0, 0.1) == 25);  // between 2 and 3
  CHECK(value(4.0, 4.0) == 35);  // texels 2 to 5
  CHECK(value(0.0, 1.0) == 0);   // beyond the end, the end
  CHECK(value(99.0, 1.0) == 70);
  CHECK(value(1.0, 1.0, 1) == 5);
}
