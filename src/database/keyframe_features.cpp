#include "database/keyframe_features.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace vpr {
namespace {

constexpr double kWorkingSide = 320;  // pixels of the longer side
constexpr int kEdge = 16;             // pixels without features
constexpr int kPatch = 31;            // pixels
// Gray levels around a corner: the second one if the first finds too few features.
constexpr int kFastThreshold = 20;
constexpr int kLowFastThreshold = 10;
constexpr size_t kFew = 75;

}  // namespace

cv::Mat working_image(const cv::Mat& gray) {
  const auto divisor = std::lround(std::max(gray.rows, gray.cols) / kWorkingSide);
  if (divisor < 2) return gray;
  cv::Mat working;
  const auto part = [&](int side) { return std::max(1, side / static_cast<int>(divisor)); };
  cv::resize(gray, working, {part(gray.cols), part(gray.rows)}, 0, 0, cv::INTER_AREA);
  return working;
}

std::vector<LocalFeature> find_local_features(const cv::Mat& working) {
  if (std::min(working.rows, working.cols) <= 2 * kEdge) return {};
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
  for (const int threshold : {kFastThreshold, kLowFastThreshold})
    if (points.size() < kFew)
      cv::ORB::create(kMostFeatures, 2, 1, kEdge, 0, 2, cv::ORB::HARRIS_SCORE, kPatch, threshold)
          ->detectAndCompute(working, cv::noArray(), points, descriptors);
  std::vector<LocalFeature> features(std::min(points.size(), kMostFeatures));
  for (size_t i = 0; i < features.size(); ++i) {
    std::memcpy(features[i].bits.data(), descriptors.ptr(static_cast<int>(i)),
                features[i].bits.size());
    features[i].x = points[i].pt.x;
    features[i].y = points[i].pt.y;
  }
  return features;
}

void KeyframeFeatures::append(uint32_t frame, std::span<const LocalFeature> features) {
  assert(frames.empty() || frames.back() < frame);
  frames.push_back(frame);
  all.insert(all.end(), features.begin(), features.end());
  ends.push_back(static_cast<uint32_t>(all.size()));
}

std::span<const LocalFeature> KeyframeFeatures::of(size_t keyframe) const {
  const size_t first = keyframe == 0 ? 0 : ends[keyframe - 1];
  return std::span(all).subspan(first, ends[keyframe] - first);
}

size_t KeyframeFeatures::count_until(size_t frame) const {
  return static_cast<size_t>(std::ranges::upper_bound(frames, frame) - frames.begin());
}

DescriptorRows bits_of(std::span<const LocalFeature> features) {
  constexpr DescriptorShape kShape = {ElementType::bits, 8 * sizeof(LocalFeature::bits)};
  return {kShape,
          {reinterpret_cast<const uint8_t*>(features.data()), features.size_bytes()},
          sizeof(LocalFeature)};
}

}  // namespace vpr
