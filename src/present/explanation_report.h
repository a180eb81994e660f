// Why a frame was taken for a place of FAB-MAP: as JSON ("explanation" of a result), for people,
// and as pictures.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/json_fwd.h"
#include "run/fabmap_query.h"

namespace vpr {

Json explanation_json(const Explanation& explanation);
std::string explanation_text(const Explanation& explanation);

/// A place in an image where a word was seen.
struct MarkedPoint {
  cv::Point2f at;
  uint32_t word = 0;
  bool speaks_for = true;
};

/// A frame, and where on it words were seen.
struct MarkedImage {
  cv::Mat gray;  ///< 8 bits; empty: left blank
  std::vector<MarkedPoint> points;
  std::string title;
};

/// A query frame and a view, side by side.
struct ImagePair {
  MarkedImage query;
  MarkedImage view;
};

/// The words of a frame that speak for and against the place, marked where they are.
MarkedImage mark_words(const FrameFeatures& features, const PlaceExplanation& place,
                       const std::string& title);

/// One row a pair. Words that speak for the place have the color of what is right, and are joined
/// by a line where both images show them; those against have that of what is wrong. BGR, 8 bits.
cv::Mat draw_word_pairs(const std::vector<ImagePair>& pairs);

}  // namespace vpr
