// Two images side by side with the words that speak for and against their being one place.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace vpr {

/// A place in an image where a word was seen.
struct MarkedPoint {
  cv::Point2f at;
  uint32_t word = 0;
  bool speaks_for = true;
};

/// A frame, and where on it words were seen.
struct MarkedImage {
  cv::Mat grey;  ///< 8 bits; empty: left blank
  std::vector<MarkedPoint> points;
  std::string title;
};

/// A query frame and a view, side by side.
struct ImagePair {
  MarkedImage query;
  MarkedImage view;
};

/// One row a pair. Words that speak for the place have the colour of what is right, and are joined
/// by a line where both images show them; those against have that of what is wrong. BGR, 8 bits.
cv::Mat draw_word_pairs(const std::vector<ImagePair>& pairs);

}  // namespace vpr
