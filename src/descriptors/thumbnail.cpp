#include "descriptors/thumbnail.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/mat.hpp>

#include "descriptors/shrink.h"

namespace vpr {
namespace {

constexpr double kDeviation = 32;  // grey levels

void normalise_square(const cv::Mat& small, int left, int top, Thumbnail64& out) {
  constexpr int kPixels = kThumbnailPatch * kThumbnailPatch;
  int sum = 0;
  int squares = 0;
  for (int y = top; y < top + kThumbnailPatch; ++y) {
    const uint8_t* row = small.ptr<uint8_t>(y);
    for (int x = left; x < left + kThumbnailPatch; ++x) {
      sum += row[x];
      squares += row[x] * row[x];
    }
  }
  // Of 64 p - sum, the deviation is the root of 64 squares - sum^2.
  const double deviation = std::sqrt(static_cast<double>(kPixels * squares - sum * sum));
  for (int y = top; y < top + kThumbnailPatch; ++y) {
    const uint8_t* row = small.ptr<uint8_t>(y);
    for (int x = left; x < left + kThumbnailPatch; ++x) {
      const double level =
          deviation > 0 ? 128 + kDeviation * (kPixels * row[x] - sum) / deviation : 128;
      out[static_cast<size_t>(y * kThumbnailWidth + x)] =
          static_cast<uint8_t>(std::clamp(std::nearbyint(level), 0.0, 255.0));
    }
  }
}

}  // namespace

Thumbnail64 describe_thumbnail(const cv::Mat& grey) {
  const cv::Mat small = shrink(grey, kThumbnailWidth, kThumbnailHeight);
  Thumbnail64 thumbnail;
  for (int y = 0; y < kThumbnailHeight; y += kThumbnailPatch)
    for (int x = 0; x < kThumbnailWidth; x += kThumbnailPatch)
      normalise_square(small, x, y, thumbnail);
  return thumbnail;
}

}  // namespace vpr
