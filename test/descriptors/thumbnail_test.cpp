#include "descriptors/thumbnail.h"

#include <cmath>

#include <catch2/catch.hpp>
#include <opencv2/core/mat.hpp>

#include "base/random.h"
#include "descriptors/shrink.h"

using namespace vpr;

namespace {

cv::Mat random_picture(int width, int height, uint64_t seed) {
  RandomEngine engine(seed);
  cv::Mat picture(height, width, CV_8U);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      picture.at<uint8_t>(y, x) = static_cast<uint8_t>(uniform_below(engine, 256));
  return picture;
}

// The area that both pixels cover, for pixels of two pictures of one extent.
double overlap(int x, int pixels, int other, int others) {
  const double width = 1.0 / pixels;
  const double first = std::max(x * width, other / double(others));
  return std::max(0.0, std::min((x + 1) * width, (other + 1) / double(others)) - first) / width;
}

double plain_mean(const cv::Mat& picture, int x, int y, int width, int height) {
  double sum = 0;
  for (int v = 0; v < picture.rows; ++v)
    for (int u = 0; u < picture.cols; ++u)
      sum += overlap(x, width, u, picture.cols) * overlap(y, height, v, picture.rows) *
             picture.at<uint8_t>(v, u);
  return sum;
}

// The mean and deviation of a square, and what they make of each of its pixels.
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

}  // namespace

TEST_CASE("pictures shrink to means of areas") {
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
    const cv::Mat picture = random_picture(width, height, 1);
    const cv::Mat small = shrink(picture, 64, 32);
    for (int y = 0; y < 32; y += 5)
      for (int x = 0; x < 64; ++x)
        REQUIRE(small.at<uint8_t>(y, x) ==
                Approx(plain_mean(picture, x, y, 64, 32)).margin(0.5000001));
  }
}

TEST_CASE("thumbnails are normalised square by square") {
  for (const auto& [width, height] : std::vector<std::pair<int, int>>{{64, 32}, {160, 120}}) {
    const cv::Mat picture = random_picture(width, height, 2);
    const Thumbnail64 found = describe_thumbnail(picture);
    const cv::Mat small = shrink(picture, 64, 32);
    for (int top = 0; top < 32; top += 8)
      for (int left = 0; left < 64; left += 8) check_square(small, found, left, top);
  }
}

TEST_CASE("light and contrast of a square do not count, and one without any is grey") {
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
