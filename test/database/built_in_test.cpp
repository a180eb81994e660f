// Built-in descriptors of whole frames.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

#include "base/random.h"
#include "database/whole_frame.h"

using namespace vpr;

namespace {

cv::Mat random_image(int width, int height, uint64_t seed) {
  RandomEngine engine(seed);
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.at<uint8_t>(y, x) = static_cast<uint8_t>(engine());
  return image;
}

// The definition without an integral image, pixel by pixel.
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

LdbCode slow_ldb(const cv::Mat& gray) {
  cv::Mat small;
  cv::resize(gray, small, {64, 64}, 0, 0, cv::INTER_LINEAR_EXACT);
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

// The overlap of two pixels, in two images with the same extent.
double overlap(int x, int pixels, int other, int others) {
  const double width = 1.0 / pixels;
  const double first = std::max(x * width, other / double(others));
  return std::max(0.0, std::min((x + 1) * width, (other + 1) / double(others)) - first) / width;
}

double reference_mean(const cv::Mat& picture, int x, int y, int width, int height) {
  double sum = 0;
  for (int v = 0; v < picture.rows; ++v)
    for (int u = 0; u < picture.cols; ++u)
      sum += overlap(x, width, u, picture.cols) * overlap(y, height, v, picture.rows) *
             picture.at<uint8_t>(v, u);
  return sum;
}

// Normalizes a square by its mean and deviation, and compares its pixels.
void check_square(const cv::Mat& small, const Thumbnail64& found, int left, int top) {
  double mean = 0;
  for (int i = 0; i < 64; ++i) mean += small.at<uint8_t>(top + i / 8, left + i % 8) / 64.0;
  double variance = 0;
  for (int i = 0; i < 64; ++i)
    variance += std::pow(small.at<uint8_t>(top + i / 8, left + i % 8) - mean, 2) / 64;
  for (int i = 0; i < 64; ++i) {
    const double pixel = small.at<uint8_t>(top + i / 8, left + i % 8);
    const double level = 128 + 32 * (pixel - mean) / std::sqrt(variance);
    const int out = found[static_cast<size_t>((top + i / 8) * 64 + left + i % 8)];
    REQUIRE(out == Approx(std::min(std::max(level, 0.0), 255.0)).margin(0.5000001));
  }
}

// The strongest direction of the block in the middle of the image: one of 8 over half a turn.
int strongest_direction(const HogVector& descriptor) {
  const auto block = descriptor.begin() + (1 * 3 + 1) * 32;
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

int invariant(int b, int g, int r) {
  return illumination_invariant(cv::Mat(1, 1, CV_8UC3, cv::Scalar(b, g, r))).at<uint8_t>(0, 0);
}

}  // namespace

TEST_CASE("a uniform image sets no bit, because no cell exceeds another") {
  CHECK(describe_ldb(cv::Mat(48, 64, CV_8UC1, cv::Scalar(77))) == LdbCode{});
}

TEST_CASE("an image that darkens to the right sets the intensity bits of left against right") {
  cv::Mat image(64, 64, CV_8UC1);
  for (int x = 0; x < 64; ++x) image.col(x).setTo(252 - 4 * x);
  const LdbCode code = describe_ldb(image);
  // Grid 2x2, pairs (0,1) (0,2) (0,3) (1,2) (1,3) (2,3), three bits each: cells 0 and 2 are on the
  // left.
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

TEST_CASE("cell values equal values computed by hand") {
  // One bright pixel, at row 1, column 1 of the window: first row and column of cell 0.
  cv::Mat window = cv::Mat::zeros(60, 60, CV_8UC1);
  window.at<uint8_t>(1, 1) = 9;
  window.at<uint8_t>(0, 5) = 200;  // row 0 is outside all cells
  cv::Mat integral;
  cv::integral(window, integral, CV_32S);
  const auto values = ldb_cell_values(integral, 2);
  CHECK(values[0][0] == 9);
  CHECK(values[1][0] == 9 - 2 * 9);
  CHECK(values[2][0] == 9 - 2 * 9);
  CHECK(values[0][1] == 0);
}

TEST_CASE("the integral image yields the same code as direct sums, for any image size") {
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

TEST_CASE("images shrink to area means") {
  cv::Mat line(1, 3, CV_8U);
  line.at<uint8_t>(0, 0) = 10;
  line.at<uint8_t>(0, 1) = 20;
  line.at<uint8_t>(0, 2) = 41;
  const cv::Mat half = shrink(line, 2, 1);  // (10 + 10) / 1.5 = 13.33, (10 + 41) / 1.5 = 34
  CHECK(half.at<uint8_t>(0, 0) == 13);
  CHECK(half.at<uint8_t>(0, 1) == 34);
  CHECK(shrink(line, 1, 1).at<uint8_t>(0, 0) == 24);  // 23.67
  const cv::Mat wide = shrink(line, 6, 2);
  CHECK(wide.at<uint8_t>(1, 1) == 10);
  CHECK(wide.at<uint8_t>(0, 5) == 41);
  for (const auto& [width, height] :
       std::vector<std::pair<int, int>>{{64, 32}, {63, 33}, {160, 120}, {101, 7}, {1, 1}}) {
    const cv::Mat picture = random_image(width, height, 1);
    const cv::Mat small = shrink(picture, 64, 32);
    for (int y = 0; y < 32; y += 5)
      for (int x = 0; x < 64; ++x)
        REQUIRE(small.at<uint8_t>(y, x) ==
                Approx(reference_mean(picture, x, y, 64, 32)).margin(0.5000001));
  }
}

TEST_CASE("thumbnails are normalized in each square") {
  for (const auto& [width, height] : std::vector<std::pair<int, int>>{{64, 32}, {160, 120}}) {
    const cv::Mat picture = random_image(width, height, 2);
    const Thumbnail64 found = describe_thumbnail(picture);
    const cv::Mat small = shrink(picture, 64, 32);
    for (int top = 0; top < 32; top += 8)
      for (int left = 0; left < 64; left += 8) check_square(small, found, left, top);
  }
}

TEST_CASE("brightness and contrast of a square have no effect, and a uniform square is gray") {
  cv::Mat picture(32, 64, CV_8U, cv::Scalar(77));
  const Thumbnail64 flat = describe_thumbnail(picture);
  CHECK(std::all_of(flat.begin(), flat.end(), [](uint8_t level) { return level == 128; }));
  for (int i = 0; i < 32; ++i) picture.at<uint8_t>(i / 8, i % 8) = 78;  // half of the first square
  const Thumbnail64 half = describe_thumbnail(picture);
  CHECK(half[0] == 160);      // one deviation above
  CHECK(half[4 * 64] == 96);  // one below
  CHECK(half[8] == 128);      // the next square
  cv::Mat brighter = picture.clone();
  for (int i = 0; i < 64; ++i)
    brighter.at<uint8_t>(i / 8, i % 8) =
        static_cast<uint8_t>(3 * (picture.at<uint8_t>(i / 8, i % 8) - 70));
  CHECK(describe_thumbnail(brighter) == half);
  picture.setTo(0);
  picture.at<uint8_t>(0, 0) = 255;  // 7.9 deviations above
  CHECK(describe_thumbnail(picture)[0] == 255);
}

TEST_CASE("histograms of gradients have the direction of the image's gradients") {
  for (int bin = 0; bin < 8; ++bin) {
    const int found = strongest_direction(describe_hog(ramp((bin + 0.5) * 22.5)));
    INFO("direction " << bin);
    CHECK(found == bin);
  }
}

TEST_CASE("brightness has no effect on HOG, and an image without gradients is all zero") {
  const cv::Mat picture = ramp(30);
  cv::Mat brighter;
  picture.convertTo(brighter, CV_8U, 1, 40);
  CHECK(describe_hog(picture) == describe_hog(brighter));
  CHECK(describe_hog(cv::Mat(120, 160, CV_8U, cv::Scalar(90))) == HogVector{});
}

TEST_CASE("a vertical edge is in the cells and the direction next to it") {
  cv::Mat edge(64, 64, CV_8U, cv::Scalar(0));
  edge.colRange(8, 64).setTo(200);  // between the pixels 7 and 8, the center of the first cells
  const HogVector hog = describe_hog(edge);
  // The gradient at 0 degrees is between the first direction (11.25) and the last (168.75).
  const auto value = [&](size_t block, size_t cell, size_t k) {
    return int{hog[(block * 4 + cell) * 8 + k]};
  };
  CHECK(value(0, 0, 0) == 127);
  CHECK(value(0, 0, 7) == 127);
  for (size_t k = 1; k < 7; ++k) CHECK(value(0, 0, k) == 0);
  CHECK(value(0, 1, 0) < 20);    // 1/32 of each pixel
  CHECK(value(0, 2, 0) == 127);  // the cell below
  CHECK(value(1, 0, 0) > 0);     // the same cells as in block 0, normalized without the others
  CHECK(value(2, 0, 0) == 0);    // columns 2 and 3 have no gradient
}

TEST_CASE("LDB and HOG of a frame follow one another within a row") {
  const cv::Mat picture = random_image(160, 120, 3);
  const LdbHogRow row = describe_ldb_hog(picture);
  const LdbCode code = describe_ldb(picture);
  const HogVector hog = describe_hog(picture);
  CHECK(std::equal(code.begin(), code.end(), row.begin()));
  CHECK(std::memcmp(row.data() + code.size(), hog.data(), hog.size()) == 0);
}

TEST_CASE("illumination invariance equals its formula, computed by hand") {
  CHECK(invariant(128, 128, 128) == 128);  // 0.5 * 255 = 127.5, to the even neighbor
  // 0.5 + ln(100/255) - 0.47 ln(50/255) - 0.53 ln(200/255) = 0.4584; times 255 = 116.9
  CHECK(invariant(50, 100, 200) == 117);
}

TEST_CASE("gray of any brightness has the same illumination-invariant value") {
  for (int gray = 1; gray < 256; gray += 13)
    CHECK(std::abs(invariant(gray, gray, gray) - 127.5) < 1);
}

TEST_CASE("the logarithm of zero counts as zero, and values below zero become one") {
  CHECK(invariant(0, 0, 0) == 128);
  CHECK(invariant(255, 1, 255) == 255);  // 0.5 + ln(1/255) < 0
  CHECK(invariant(1, 255, 255) == 255);  // saturated
}
