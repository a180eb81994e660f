// Reference implementations of vocabularies and Chow-Liu trees.
#pragma once

#include <span>

#include "fabmap/chow_liu.h"

namespace cv {
class Mat;
}

namespace vpr {

/// train_chow_liu by sorting all pairs of words and joining them one by one (Kruskal).
ChowLiuTree reference_chow_liu(std::span<const WordSet> frames, size_t words);

/// radius_words by comparing every row with every center, one by one.
cv::Mat reference_radius_words(const cv::Mat& descriptors, double radius);

}  // namespace vpr
