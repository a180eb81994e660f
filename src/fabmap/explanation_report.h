// Explanations of FAB-MAP's matches as text and images.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "fabmap/place_query.h"

namespace vpr {

std::string explanation_text(const Explanation& explanation);

/// A word at its position in an image.
struct MarkedPoint {
  cv::Point2f at;
  uint32_t word = 0;
  bool speaks_for = true;  ///< increases the probability of the place
};

/// A frame and its words.
struct MarkedImage {
  cv::Mat gray;  ///< 8 bits; empty: blank
  std::vector<MarkedPoint> points;
  std::string title;
};

struct ImagePair {
  MarkedImage query;
  MarkedImage view;
};

/// Decodes one frame of a sequence and finds its words. Throws Error(input) if the sequence has no
/// such frame, or it cannot be decoded.
MarkedImage locate_words(const SequenceSource& sequence, size_t frame,
                         const FabmapDatabase& database, const Monitor& monitor);

/// Only the words that speak for and against the place.
MarkedImage mark_words(const MarkedImage& located, const PlaceExplanation& place,
                       const std::string& title);

/// One row per pair, BGR, 8 bits. Words have the color of Meaning::correct if they speak for the
/// place, else of Meaning::incorrect. Lines connect words for the place that are in both images.
cv::Mat draw_word_pairs(const std::vector<ImagePair>& pairs);

}  // namespace vpr
