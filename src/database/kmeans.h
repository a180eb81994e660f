// Vocabularies by k-means: Euclidean for floats, k-majority (Hamming) for bits.
#pragma once

#include <cstdint>

#include "base/monitor.h"
#include "base/random.h"

namespace cv {
class Mat;
}

namespace vpr {

/// How k-means makes words.
struct KmeansSettings {
  size_t words = 1000;
  size_t iterations = 20;  ///< Lloyd steps at most; fewer when no point changes its centre
  uint64_t seed = 1;
};

/// `descriptors`: one row each, CV_32F or CV_8U (bits). Returns `words` rows of the same type.
/// Starts from k-means++ (Arthur & Vassilvitskii), or from k-means|| (Bahmani et al.) where points
/// x words is large. A centre without members stays where it is. The same seed gives the same words
/// for any number of threads and any SIMD target.
/// Throws Error(usage) if there are fewer descriptors than words, or no word is asked for.
cv::Mat kmeans_words(const cv::Mat& descriptors, const KmeansSettings& settings,
                     const Monitor& monitor);

}  // namespace vpr
