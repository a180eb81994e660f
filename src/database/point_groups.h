// Descriptors as points: what the ways to make a vocabulary share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "base/parallel.h"
#include "descriptors/nearest_centre.h"

namespace cv {
class Mat;
}

namespace vpr {

// Points are rows: CV_32F, compared by Euclidean distance, or CV_8U strings of bits, by Hamming
// distance, which is the squared distance of the bits as numbers.

/// Calls body(begin, end) for chunks of [0, points), in any order, from several threads.
template <class Body>
void for_chunks(size_t points, const Monitor& monitor, Body&& body) {
  constexpr size_t kChunk = 1024;
  parallel_for((points + kChunk - 1) / kChunk, monitor,
               [&](size_t c) { body(c * kChunk, std::min(points, (c + 1) * kChunk)); });
}

/// begin, begin + 1, ..., end - 1.
inline std::vector<uint32_t> row_range(size_t begin, size_t end) {
  std::vector<uint32_t> rows(end - begin);
  std::iota(rows.begin(), rows.end(), static_cast<uint32_t>(begin));
  return rows;
}

/// A copy of some rows, in the order of `indices`.
cv::Mat rows_of(const cv::Mat& points, const std::vector<size_t>& indices);

/// The squared Euclidean distance of row i of a and row j of b.
double squared_distance(const cv::Mat& a, size_t i, const cv::Mat& b, size_t j);

/// Whether a is nearer than b, by score; of equals the lower index is.
inline bool nearer(const NearestCentre& a, const NearestCentre& b) {
  return a.score < b.score || (a.score == b.score && a.centre < b.centre);
}

/// Moves every centre to the mean of the points assigned to it (bits: to what more than half of
/// them have set), summed in index order in double; one without points stays. Says which ones
/// moved.
std::vector<char> move_centres(const cv::Mat& points, const std::vector<NearestCentre>& assigned,
                               cv::Mat& centres, const Monitor& monitor);

}  // namespace vpr
