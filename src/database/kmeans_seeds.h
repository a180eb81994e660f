// Where k-means starts: k-means++ and k-means||, and what they share with its steps.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/monitor.h"
#include "base/parallel.h"
#include "base/random.h"
#include "descriptors/nearest_centre.h"

namespace vpr {

/// `count` rows of `points` (CV_32F, or CV_8U strings of bits) to start from: by k-means++ (Arthur
/// & Vassilvitskii 2007), or by k-means|| (Bahmani et al. 2012) where points x count is large.
/// count <= rows. Depends on the points and the engine alone.
cv::Mat choose_seeds(const cv::Mat& points, size_t count, RandomEngine& engine,
                     const Monitor& monitor);

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

/// By score; the lower index among equals.
inline bool nearer(const NearestCentre& a, const NearestCentre& b) {
  return a.score < b.score || (a.score == b.score && a.centre < b.centre);
}

}  // namespace vpr
