#include "descriptors/centre_codes.h"

#include <bit>
#include <cmath>
#include <vector>

#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>

#include "base/random.h"

using namespace vpr;

namespace {

// Smooth, and different everywhere.
cv::Mat picture(int width, int height, uint64_t seed) {
  RandomEngine engine(seed);
  cv::Mat coarse(6, 6, CV_8U);
  for (auto level = coarse.begin<uint8_t>(); level != coarse.end<uint8_t>(); ++level)
    *level = static_cast<uint8_t>(uniform_below(engine, 256));
  cv::Mat fine;
  cv::resize(coarse, fine, {width, height}, 0, 0, cv::INTER_CUBIC);
  return fine;
}

int distance(const CentreCode& a, const CentreCode& b) {
  int bits = 0;
  for (size_t i = 0; i < a.size(); ++i) bits += std::popcount(static_cast<uint8_t>(a[i] ^ b[i]));
  return bits;
}

int set_bits(const CentreCode& code) { return distance(code, CentreCode{}); }

// BRIEF in double precision: the sum over the Gaussian's 81 weights, pixel by pixel.
double smooth_at(const cv::Mat& square, int x, int y) {
  double sum = 0;
  double weights = 0;
  for (int down = -4; down <= 4; ++down)
    for (int right = -4; right <= 4; ++right) {
      const double weight = std::exp(-(down * down + right * right) / 8.0);
      sum += weight * square.at<uint8_t>(32 + y + down, 32 + x + right);
      weights += weight;
    }
  return sum / weights;
}

}  // namespace

TEST_CASE("the pairs of BRIEF are normally distributed within the patch") {
  double squares = 0;
  double sum = 0;
  for (const BriefPair& pair : brief_pairs())
    for (const int offset : {pair.first_x, pair.first_y, pair.second_x, pair.second_y}) {
      CHECK(offset >= -24);
      CHECK(offset <= 23);
      squares += offset * offset;
      sum += offset;
    }
  CHECK(std::abs(sum / 1024) < 1);
  CHECK(std::abs(std::sqrt(squares / 1024) - 48 / 5.0) < 0.7);
}

TEST_CASE("a code of the centre is that of plain comparisons") {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const cv::Mat square = picture(64, 64, seed);  // not resized
    const CentreCode code = describe_brief(square);
    int close = 0;
    for (size_t bit = 0; bit < kCentreBits; ++bit) {
      const BriefPair& pair = brief_pairs()[bit];
      const double more = smooth_at(square, pair.second_x, pair.second_y) -
                          smooth_at(square, pair.first_x, pair.first_y);
      if (std::abs(more) < 1.1) {  // rounded to whole grey levels, either may be
        ++close;
        continue;
      }
      CHECK((code[bit / 8] >> bit % 8 & 1) == (more > 0 ? 1 : 0));
    }
    CHECK(close < 26);
  }
}

TEST_CASE("codes of the centre see order, not light") {
  for (const auto describe : {describe_brief, describe_orb}) {
    const cv::Mat scene = picture(320, 240, 3);
    const CentreCode code = describe(scene);
    CHECK(code == describe(scene.clone()));
    CHECK(set_bits(code) > 60);
    CHECK(set_bits(code) < 196);
    CHECK(set_bits(describe(cv::Mat(240, 320, CV_8U, cv::Scalar(90)))) == 0);
    cv::Mat darker;
    scene.convertTo(darker, CV_8U, 0.5, 10);
    CHECK(distance(code, describe(darker)) < 25);
    // Of the negative, every bit of two different pixels is the other one.
    CHECK(distance(code, describe(255 - scene)) > 231);
    CHECK(distance(code, describe(picture(320, 240, 4))) > 60);
  }
}

TEST_CASE("ORB looks at the middle of the frame only") {
  const cv::Mat scene = picture(128, 128, 7);
  const CentreCode code = describe_orb(scene);
  cv::Mat covered = scene.clone();
  covered.rowRange(0, 38).setTo(0);
  covered.colRange(92, 128).setTo(255);
  CHECK(describe_orb(covered) == code);
  covered.rowRange(50, 80).setTo(0);
  CHECK(describe_orb(covered) != code);
}
