// A small recording whose pictures are made with whole numbers only: the same on every machine,
// with any version of any library.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace vpr::test {

/// A walk along a painted wall, eight columns of it a frame.
struct Walk {
  std::string name;
  uint64_t wall = 0;  ///< walks along the same wall see the same
  size_t first = 0;   ///< where on the wall it starts, in frames
  size_t frames = 0;
  int light = 256;  ///< of 256: what is left of every grey
  int noise = 0;    ///< greys are off by up to so much
};

/// Pretraining, two training walks and a query along the first of them, in other light.
inline const Walk kPretrain{"pretrain", 3, 0, 16};
inline const std::vector<Walk> kTrain = {{"north", 1, 0, 20}, {"south", 2, 0, 12}};
inline const Walk kQuery{"back", 1, 3, 14, 230, 9};

/// 80x60 pixels, 8 bits, grey.
cv::Mat draw_frame(const Walk& walk, size_t frame);

/// 70 local features of a frame: its squares of 8x8 pixels, row by row, as 64 greys each (CV_32F).
/// Products of such rows are whole numbers below 2^24, so that floats hold them exactly.
cv::Mat square_features(const cv::Mat& frame);

}  // namespace vpr::test
