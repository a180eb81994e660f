#include "golden/recording.h"

#include <algorithm>

#include "base/random.h"

namespace vpr::test {
namespace {

constexpr int kWidth = 80;
constexpr int kHeight = 60;
constexpr int kStep = 8;  // columns per frame
constexpr int kSquare = 8;
constexpr int kWallLength = kWidth + kStep * 24;
constexpr int kPanels = 120;

int below(RandomEngine& engine, int bound) {
  return static_cast<int>(uniform_below(engine, static_cast<uint64_t>(bound)));
}

// Overlapping panels of one gray level each.
cv::Mat paint_wall(uint64_t seed) {
  RandomEngine engine = named_engine(seed, "wall");
  cv::Mat wall(kHeight, kWallLength, CV_8UC1, cv::Scalar(120));
  for (int panel = 0; panel < kPanels; ++panel) {
    const int left = below(engine, kWallLength);
    const int top = below(engine, kHeight);
    const int right = std::min(left + 4 + below(engine, 30), kWallLength);
    const int bottom = std::min(top + 4 + below(engine, 24), kHeight);
    const auto gray = static_cast<uint8_t>(below(engine, 256));
    for (int row = top; row < bottom; ++row)
      std::fill(wall.ptr(row) + left, wall.ptr(row) + right, gray);
  }
  return wall;
}

}  // namespace

cv::Mat draw_frame(const Walk& walk, size_t frame) {
  const cv::Mat wall = paint_wall(walk.wall);
  RandomEngine engine = named_engine(frame, walk.name);
  const int left = kStep * static_cast<int>(walk.first + frame);
  cv::Mat picture(kHeight, kWidth, CV_8UC1);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const int off = walk.noise == 0 ? 0 : below(engine, 2 * walk.noise + 1) - walk.noise;
      const int gray = wall.at<uint8_t>(row, left + column) * walk.light / 256 + off;
      picture.at<uint8_t>(row, column) = static_cast<uint8_t>(std::clamp(gray, 0, 255));
    }
  }
  return picture;
}

cv::Mat square_features(const cv::Mat& frame) {
  cv::Mat features(0, kSquare * kSquare, CV_32F);
  for (int top = 0; top + kSquare <= frame.rows; top += kSquare) {
    for (int left = 0; left + kSquare <= frame.cols; left += kSquare) {
      cv::Mat feature(1, kSquare * kSquare, CV_32F);
      for (int i = 0; i < kSquare * kSquare; ++i)
        feature.at<float>(i) = frame.at<uint8_t>(top + i / kSquare, left + i % kSquare);
      features.push_back(feature);
    }
  }
  return features;
}

}  // namespace vpr::test
