// Vocabularies from points: by k-means (Euclidean for floats, k-majority by Hamming distance for
// bits), or by a radius; and what both do with points.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "base/parallel.h"
#include "base/random.h"
#include "fabmap/nearest_centre.h"

namespace cv {
class Mat;
}

namespace vpr {

// Points are rows: CV_32F, compared by Euclidean distance, or CV_8U strings of bits, by Hamming
// distance, which is the squared distance of the bits as numbers.

/// A copy of some rows, in the order of `indices`.
cv::Mat rows_of(const cv::Mat& points, const std::vector<size_t>& indices);

/// The squared Euclidean distance of row i of a and row j of b.
double squared_distance(const cv::Mat& a, size_t i, const cv::Mat& b, size_t j);

/// Moves every centre to the mean of the points assigned to it (bits: to what more than half of
/// them have set), summed in index order in double; one without points stays. Says which ones
/// moved.
std::vector<char> move_centres(const cv::Mat& points, const std::vector<NearestCentre>& assigned,
                               cv::Mat& centres, const Monitor& monitor);

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

/// OpenFABMAP's sequential clustering: every row of `descriptors` (CV_32F or CV_8U) that is farther
/// than `radius` from all centres so far becomes one; then each row is assigned to its nearest
/// centre (ties to the lower one), and centres move to their members once. The distance of floats
/// is Euclidean, of bits Hamming. Depends on the order of rows. Throws Error(usage) if there is no
/// descriptor, the radius is not above 0, or there are more than `most_words` centres.
cv::Mat radius_words(const cv::Mat& descriptors, double radius, size_t most_words,
                     const Monitor& monitor);

}  // namespace vpr
