#include "descriptors/ldb.h"

#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>

#include "base/random.h"

using namespace vpr;

namespace {

cv::Mat random_image(int width, int height, uint64_t seed) {
  RandomEngine engine(seed);
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.at<uint8_t>(y, x) = static_cast<uint8_t>(engine());
  return image;
}

// The recipe read aloud: no integral image, one pixel after the other.
std::array<int, 3> slow_cell(const cv::Mat& window, int g, int r, int c) {
  const int side = 60 / g;
  const int half = (side - 1) / 2;
  std::array<int, 3> v{};
  for (int y = r * side + 1; y <= (r + 1) * side - 1; ++y) {
    for (int x = c * side + 1; x <= (c + 1) * side - 1; ++x) {
      const int value = window.at<uint8_t>(y, x);
      v[0] += value;
      v[1] += x - (c * side + 1) < half ? -value : value;
      v[2] += y - (r * side + 1) < half ? -value : value;
    }
  }
  return v;
}

LdbCode slow_ldb(const cv::Mat& grey) {
  cv::Mat small;
  cv::resize(grey, small, {64, 64}, 0, 0, cv::INTER_LINEAR_EXACT);
  cv::GaussianBlur(small, small, {7, 7}, 2, 2, cv::BORDER_REFLECT_101);
  const cv::Mat window = small(cv::Range(3, 63), cv::Range(3, 63));
  LdbCode code{};
  size_t bit = 0;
  for (int g = 2; g <= 5; ++g)
    for (int i = 0; i < g * g; ++i)
      for (int j = i + 1; j < g * g; ++j)
        for (size_t k = 0; k < 3; ++k, ++bit)
          if (slow_cell(window, g, i / g, i % g)[k] > slow_cell(window, g, j / g, j % g)[k])
            code[bit / 8] = static_cast<uint8_t>(code[bit / 8] | 1 << bit % 8);
  return code;
}

}  // namespace

TEST_CASE("a uniform image has no bit set, since no cell exceeds another") {
  CHECK(describe_ldb(cv::Mat(48, 64, CV_8UC1, cv::Scalar(77))) == LdbCode{});
}

TEST_CASE("an image that darkens to the right sets the intensity bits of left against right") {
  cv::Mat image(64, 64, CV_8UC1);
  for (int x = 0; x < 64; ++x) image.col(x).setTo(252 - 4 * x);
  const LdbCode code = describe_ldb(image);
  // Grid 2x2, pairs (0,1) (0,2) (0,3) (1,2) (1,3) (2,3), three bits each: cells 0 and 2 are left.
  const auto intensity_bit = [&](int pair) {
    return code[size_t(pair * 3 / 8)] >> (pair * 3 % 8) & 1;
  };
  CHECK(intensity_bit(0) == 1);
  CHECK(intensity_bit(1) == 0);
  CHECK(intensity_bit(2) == 1);
  CHECK(intensity_bit(3) == 0);
  CHECK(intensity_bit(4) == 0);
  CHECK(intensity_bit(5) == 1);
}

TEST_CASE("cell values are those of the recipe, worked out by hand") {
  // One bright pixel, at row 1, column 1 of the window: first row and column of cell 0.
  cv::Mat window = cv::Mat::zeros(60, 60, CV_8UC1);
  window.at<uint8_t>(1, 1) = 9;
  window.at<uint8_t>(0, 5) = 200;  // row 0 belongs to no cell
  cv::Mat integral;
  cv::integral(window, integral, CV_32S);
  const auto values = ldb_cell_values(integral, 2);
  CHECK(values[0][0] == 9);
  CHECK(values[1][0] == 9 - 2 * 9);
  CHECK(values[2][0] == 9 - 2 * 9);
  CHECK(values[0][1] == 0);
}

TEST_CASE("the integral image gives what the recipe read aloud gives, for any size of image") {
  const auto [width, height] = GENERATE(table<int, int>(
      {{1, 1}, {2, 3}, {63, 65}, {64, 64}, {60, 60}, {160, 120}, {640, 480}, {7, 500}}));
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const cv::Mat image = random_image(width, height, seed);
    REQUIRE(describe_ldb(image) == slow_ldb(image));
  }
}

TEST_CASE("the padding of a code is zero") {
  const LdbCode code = describe_ldb(random_image(64, 64, 3));
  CHECK((code[173] & 0xfc) == 0);
  CHECK((code[174] == 0 && code[175] == 0));
}
