// A small recording drawn with integer arithmetic only: the same on every machine, with any version
// of any library.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace vpr::test {

/// A walk along a painted wall, eight columns per frame.
struct Walk {
  std::string name;
  uint64_t wall = 0;  ///< equal walls look the same
  size_t first = 0;   ///< start on the wall, in frames
  size_t frames = 0;
  int light = 256;  ///< factor of every gray level, in units of 1/256
  int noise = 0;    ///< maximum error of gray levels
};

/// Pretraining, two training walks and a query along the first of them, in another light.
inline const Walk kPretrain{"pretrain", 3, 0, 16};
inline const std::vector<Walk> kTrain = {{"north", 1, 0, 20}, {"south", 2, 0, 12}};
inline const Walk kQuery{"back", 1, 3, 14, 230, 9};

/// 80x60 pixels, 8 bits, gray.
cv::Mat draw_frame(const Walk& walk, size_t frame);

/// 70 local features of a frame: its squares of 8x8 pixels, row by row, as 64 gray levels each
/// (CV_32F). Scalar products of these rows are integers below 2^24, which float represents exactly.
cv::Mat square_features(const cv::Mat& frame);

}  // namespace vpr::test
