// Vocabularies by k-means (Euclidean for floats, k-majority by Hamming distance for bits) or by
// radius clustering, and functions that both share.
#pragma once

#include <cstdint>
#include <vector>

#include "base/monitor.h"
#include "fabmap/vocabulary.h"

namespace vpr {

// Points are rows: CV_32F, compared by Euclidean distance, or CV_8U bit strings, compared by
// Hamming distance, which equals the squared distance of the bits as numbers.

cv::Mat rows_of(const cv::Mat& points, const std::vector<size_t>& indices);

double squared_distance(const cv::Mat& points, size_t i, size_t j);

/// Moves every center to the mean of its points (bits: the majority), summed in index order in
/// double; a center without points does not move. Returns which centers moved.
std::vector<char> move_centers(const cv::Mat& points, const std::vector<NearestCenter>& assigned,
                               cv::Mat& centers, const Monitor& monitor);

/// Settings of k-means.
struct KmeansSettings {
  size_t words = 1000;
  size_t iterations = 20;  ///< maximum number of Lloyd steps; fewer if no point changes its center
  uint64_t seed = 1;
};

/// `descriptors`: one per row, CV_32F or CV_8U (bits). Returns `words` rows of the same type.
/// Starts from k-means++ (Arthur & Vassilvitskii), or from k-means|| (Bahmani et al.) if points x
/// words is large. A center without members does not move. The same seed yields the same words for
/// any number of threads and any SIMD target. Throws Error(usage) if there are fewer descriptors
/// than words, or if no words are requested.
cv::Mat kmeans_words(const cv::Mat& descriptors, const KmeansSettings& settings,
                     const Monitor& monitor);

/// OpenFABMAP's sequential clustering: every row of `descriptors` (CV_32F or CV_8U) that is farther
/// than `radius` from all centers so far becomes a center; then each row is assigned to its nearest
/// center (ties to the lower index), and centers move to their members once. The distance is
/// Euclidean for floats and Hamming for bits. The result depends on the order of rows. Throws
/// Error(usage) if there are no descriptors, the radius is not above 0, or there are more than
/// `most_words` centers.
cv::Mat radius_words(const cv::Mat& descriptors, double radius, size_t most_words,
                     const Monitor& monitor);

}  // namespace vpr
