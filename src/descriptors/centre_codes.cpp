#include "descriptors/centre_codes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <vector>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "base/random.h"

namespace vpr {
namespace {

constexpr int kBriefSide = 64;
constexpr int kBriefPatch = 48;
constexpr int kOrbSide = 128;

cv::Mat resized(const cv::Mat& grey, int side) {
  assert(grey.type() == CV_8UC1 && !grey.empty());
  cv::Mat square;
  cv::resize(grey, square, {side, side}, 0, 0, cv::INTER_LINEAR_EXACT);
  return square;
}

// From twelve uniform numbers, which no mathematical library can round otherwise.
int normal_offset(RandomEngine& engine) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += uniform_unit(engine);
  const double offset = std::round(sum * kBriefPatch / 5);
  return static_cast<int>(std::clamp(offset, -kBriefPatch / 2.0, kBriefPatch / 2.0 - 1));
}

std::array<BriefPair, kCentreBits> draw_pairs() {
  RandomEngine engine = named_engine(1, "brief");
  std::array<BriefPair, kCentreBits> pairs;
  for (BriefPair& pair : pairs)
    for (int* offset : {&pair.first_x, &pair.first_y, &pair.second_x, &pair.second_y})
      *offset = normal_offset(engine);
  return pairs;
}

}  // namespace

const std::array<BriefPair, kCentreBits>& brief_pairs() {
  static const std::array<BriefPair, kCentreBits> kPairs = draw_pairs();
  return kPairs;
}

CentreCode describe_brief(const cv::Mat& grey) {
  cv::Mat smooth;
  cv::GaussianBlur(resized(grey, kBriefSide), smooth, {9, 9}, 2, 2, cv::BORDER_REFLECT_101);
  const auto pixel = [&](int x, int y) {
    return smooth.at<uint8_t>(kBriefSide / 2 + y, kBriefSide / 2 + x);
  };
  CentreCode code{};
  for (size_t bit = 0; bit < kCentreBits; ++bit) {
    const BriefPair& pair = brief_pairs()[bit];
    const bool is_darker = pixel(pair.first_x, pair.first_y) < pixel(pair.second_x, pair.second_y);
    code[bit / 8] = static_cast<uint8_t>(code[bit / 8] | int{is_darker} << bit % 8);
  }
  return code;
}

// Only the level of the keypoint is looked at: there is one.
CentreCode describe_orb(const cv::Mat& grey) {
  constexpr int kBorder = 30;
  const auto orb = cv::ORB::create(1, 1.2F, 1, kBorder, 0, 2, cv::ORB::HARRIS_SCORE, 31);
  std::vector<cv::KeyPoint> keypoints = {
      cv::KeyPoint(kOrbSide / 2 + 1, kOrbSide / 2 + 1, 1, /*angle=*/0, 0, /*octave=*/0)};
  cv::Mat descriptor;
  orb->compute(resized(grey, kOrbSide), keypoints, descriptor);
  assert(descriptor.rows == 1 && descriptor.cols == static_cast<int>(kCentreBits / 8));
  CentreCode code;
  std::memcpy(code.data(), descriptor.ptr(), code.size());
  return code;
}

}  // namespace vpr
