#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>
#include <opencv2/core/mat.hpp>

#include "synth/scene.h"
#include "synth/surfaces.h"

using namespace vpr;

namespace {

// Columns of 0, 10, 20, ... in all four channels, in the layout of a painted wall.
Texture ramp() {
  cv::Mat picture(4, 8, CV_8UC4);
  for (int x = 0; x < picture.cols; ++x) picture.col(x).setTo(cv::Scalar::all(10 * x));
  return make_wall_texture(picture);
}

}  // namespace

TEST_CASE("levels halve until a side is one texel long") {
  const Texture texture = ramp();
  REQUIRE(texture.levels.size() == 3);
  CHECK(texture.levels[0].rows == 8);  // transposed: a row is a vertical strip
  CHECK(texture.levels[0].cols == 4);
  CHECK(texture.levels[1].at<cv::Vec4b>(0, 0)[0] == 5);
  CHECK(texture.levels[2].at<cv::Vec4b>(1, 0)[0] == 55);
}

TEST_CASE("the chosen level has texels of about one pixel") {
  const Texture texture = ramp();
  CHECK(choose_level(texture, 0.1) == 0);
  CHECK(choose_level(texture, 1.4) == 0);
  CHECK(choose_level(texture, 2) == 1);
  CHECK(choose_level(texture, 1000) == 2);
}

TEST_CASE("a strip is the mean over the area of a pixel") {
  const Texture texture = ramp();
  std::vector<cv::Vec4b> strip;
  const auto value = [&](double center, double width, size_t level = 0) {
    filter_strip(texture, level, center, width, strip);
    CHECK(strip.size() == static_cast<size_t>(texture.levels[level].cols));
    return static_cast<int>(strip[0][0]);
  };
  CHECK(value(2.5, 0.1) == 20);  // the middle of texel 2
  CHECK(value(3.0, 0.1) == 25);  // between 2 and 3
  CHECK(value(4.0, 4.0) == 35);  // texels 2 to 5
  CHECK(value(0.0, 1.0) == 0);   // clamped at the end
  CHECK(value(99.0, 1.0) == 70);
  CHECK(value(1.0, 1.0, 1) == 5);
}

TEST_CASE("a panorama rotates with the direction of view") {
  const Texture panorama = make_panorama(1);
  const cv::Mat& strips = panorama.levels[0];
  const auto row_of = [&](Point direction) {
    std::vector<cv::Vec4b> strip;
    panorama_strip(panorama, direction, 1e-4, strip);
    for (int row = 0; row < strips.rows; ++row)
      if (std::equal(strip.begin(), strip.end(), strips.ptr<cv::Vec4b>(row))) return row;
    return -1;
  };
  const double step = 2 * 3.14159265358979 / strips.rows;
  const auto toward = [&](double steps) {
    return row_of({std::cos(steps * step), std::sin(steps * step)});
  };
  REQUIRE(toward(-100.5) >= 0);
  CHECK(toward(-100.5) >= toward(-0.5) + 90);
}
