#include <atomic>
#include <bit>
#include <cmath>
#include <utility>

#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>

#include "base/random.h"
#include "describe/whole_frame.h"
#include "sequence/frames.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

// A smooth image without repetition.
cv::Mat picture(int width, int height, uint64_t seed) {
  RandomEngine engine(seed);
  cv::Mat coarse(6, 6, CV_8U);
  for (auto level = coarse.begin<uint8_t>(); level != coarse.end<uint8_t>(); ++level)
    *level = static_cast<uint8_t>(uniform_below(engine, 256));
  cv::Mat fine;
  cv::resize(coarse, fine, {width, height}, 0, 0, cv::INTER_CUBIC);
  return fine;
}

int distance(const CenterCode& a, const CenterCode& b) {
  int bits = 0;
  for (size_t i = 0; i < a.size(); ++i) bits += std::popcount(static_cast<uint8_t>(a[i] ^ b[i]));
  return bits;
}

int set_bits(const CenterCode& code) { return distance(code, CenterCode{}); }

// A Gaussian of sigma 2 in double precision, pixel by pixel.
double smooth_at(const cv::Mat& square, int column, int row, int radius) {
  double sum = 0;
  double weights = 0;
  for (int down = -radius; down <= radius; ++down)
    for (int right = -radius; right <= radius; ++right) {
      const double weight = std::exp(-(down * down + right * right) / 8.0);
      sum += weight * square.at<uint8_t>(row + down, column + right);
      weights += weight;
    }
  return sum / weights;
}

constexpr double kRounding = 1.1;  // of two pixels in integer gray levels

constexpr int kOrbPatch = 31;

/// The blurred patch of ORB, row by row.
std::vector<double> orb_patch(const cv::Mat& gray) {
  cv::Mat square;
  cv::resize(gray, square, {128, 128}, 0, 0, cv::INTER_LINEAR_EXACT);
  constexpr int kFirst = 65 - kOrbPatch / 2;
  std::vector<double> patch;
  for (int row = 0; row < kOrbPatch; ++row)
    for (int column = 0; column < kOrbPatch; ++column)
      patch.push_back(smooth_at(square, kFirst + column, kFirst + row, 3));
  return patch;
}

/// The pixels of a bit in the patch: it is set if the first one is darker.
using PixelPair = std::pair<uint16_t, uint16_t>;

bool has_bit(const CenterCode& code, size_t bit) { return (code[bit / 8] >> bit % 8 & 1) != 0; }

// Whether a bit agrees with the comparison; within the rounding error it may have either value.
bool explains(const std::vector<double>& patch, const PixelPair& pair, bool bit) {
  const double more = patch[pair.second] - patch[pair.first];
  return std::abs(more) < kRounding || (more > 0) == bit;
}

/// The number of bits of a frame that the pairs do not explain.
size_t unexplained(const cv::Mat& gray, const std::vector<PixelPair>& pairs) {
  const std::vector<double> patch = orb_patch(gray);
  const CenterCode code = describe_orb(gray);
  size_t count = 0;
  for (size_t bit = 0; bit < pairs.size(); ++bit)
    count += explains(patch, pairs[bit], has_bit(code, bit)) ? 0 : 1;
  return count;
}

std::vector<cv::Mat> noise_frames(size_t count, uint64_t seed) {
  RandomEngine engine(seed);
  std::vector<cv::Mat> frames;
  for (size_t i = 0; i < count; ++i) {
    frames.emplace_back(128, 128, CV_8U);
    for (auto level = frames.back().begin<uint8_t>(); level != frames.back().end<uint8_t>();
         ++level)
      *level = static_cast<uint8_t>(uniform_below(engine, 256));
  }
  return frames;
}

// Finds, among all pairs of pixels, those that explain a bit of every frame; returns fewer pairs
// than bits if there is none, or more than one.
std::vector<PixelPair> pairs_of_orb(const std::vector<cv::Mat>& frames) {
  std::vector<std::vector<double>> patches;
  std::vector<CenterCode> codes;
  for (const cv::Mat& frame : frames) {
    patches.push_back(orb_patch(frame));
    codes.push_back(describe_orb(frame));
  }
  constexpr uint16_t kPixels = kOrbPatch * kOrbPatch;
  std::vector<PixelPair> found;
  for (size_t bit = 0; bit < kCenterBits; ++bit) {
    size_t explaining = 0;
    PixelPair last;
    for (uint16_t a = 0; a < kPixels; ++a)
      for (uint16_t b = 0; b < kPixels; ++b) {
        if (a == b) continue;
        size_t f = 0;
        while (f < patches.size() && explains(patches[f], {a, b}, has_bit(codes[f], bit))) ++f;
        if (f < patches.size()) continue;
        ++explaining;
        last = {a, b};
      }
    if (explaining == 1) found.push_back(last);
  }
  return found;
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

TEST_CASE("a code of the center equals direct comparisons") {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const cv::Mat square = picture(64, 64, seed);  // keeps its size
    const CenterCode code = describe_brief(square);
    int close = 0;
    for (size_t bit = 0; bit < kCenterBits; ++bit) {
      const BriefPair& pair = brief_pairs()[bit];
      const double more = smooth_at(square, 32 + pair.second_x, 32 + pair.second_y, 4) -
                          smooth_at(square, 32 + pair.first_x, 32 + pair.first_y, 4);
      if (std::abs(more) < kRounding) {
        ++close;
        continue;
      }
      CHECK((code[bit / 8] >> bit % 8 & 1) == (more > 0 ? 1 : 0));
    }
    CHECK(close < 26);
  }
}

TEST_CASE("codes of the center depend on the order of gray levels, not on brightness") {
  for (const auto describe : {describe_brief, describe_orb}) {
    const cv::Mat scene = picture(320, 240, 3);
    const CenterCode code = describe(scene);
    CHECK(code == describe(scene.clone()));
    CHECK(set_bits(code) > 60);
    CHECK(set_bits(code) < 196);
    CHECK(set_bits(describe(cv::Mat(240, 320, CV_8U, cv::Scalar(90)))) == 0);
    cv::Mat darker;
    scene.convertTo(darker, CV_8U, 0.5, 10);
    CHECK(distance(code, describe(darker)) < 25);
    // In the negative, every bit of two different pixels is inverted.
    CHECK(distance(code, describe(255 - scene)) > 231);
    CHECK(distance(code, describe(picture(320, 240, 4))) > 60);
  }
}

TEST_CASE("every bit of ORB compares two pixels, the same ones in every frame") {
  // OpenCV documents its 256 pairs only in its source: they are found here by exclusion, from
  // frames of noise, and must then explain every bit of other frames.
  const std::vector<PixelPair> pairs = pairs_of_orb(noise_frames(400, 1));
  REQUIRE(pairs.size() == kCenterBits);
  for (const cv::Mat& unseen : noise_frames(50, 2)) CHECK(unexplained(unseen, pairs) == 0);
  for (uint64_t seed = 1; seed <= 50; ++seed)
    CHECK(unexplained(picture(200, 150, seed), pairs) == 0);
}

TEST_CASE("every bit of ORB compares the same two pixels in real images", "[real]") {
  const std::vector<PixelPair> pairs = pairs_of_orb(noise_frames(400, 1));
  for (const char* folder : {"data/corridor/query", "data/nordland/winter"}) {
    const auto real = real_data(folder);
    if (!real) return;
    std::atomic<size_t> unlike = 0;
    for_each_frame(open_sequence({*real, FrameRange{0, 20}}), PixelFormat::gray, Unreadable::fail,
                   {}, [&](size_t, const cv::Mat& gray) { unlike += unexplained(gray, pairs); });
    CHECK(unlike == 0);
  }
}

TEST_CASE("ORB depends only on the middle of the frame") {
  const cv::Mat scene = picture(128, 128, 7);
  const CenterCode code = describe_orb(scene);
  cv::Mat covered = scene.clone();
  covered.rowRange(0, 38).setTo(0);
  covered.colRange(92, 128).setTo(255);
  CHECK(describe_orb(covered) == code);
  covered.rowRange(50, 80).setTo(0);
  CHECK(describe_orb(covered) != code);
}
