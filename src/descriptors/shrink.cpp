#include "descriptors/shrink.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace vpr {
namespace {

/// A pixel of a line, and the share of it in a pixel of the shorter line.
struct Share {
  int from = 0;
  int64_t weight = 0;
};

// With pixels of a line `shorter` long and those of one `longer` in units of which both are whole:
// pixel x covers [longer x, longer (x + 1)), pixel i of the other line [shorter i, shorter (i +
// 1)).
std::vector<std::vector<Share>> shares(int64_t longer, int64_t shorter) {
  std::vector<std::vector<Share>> all(static_cast<size_t>(shorter));
  for (int64_t x = 0; x < shorter; ++x)
    for (int64_t i = longer * x / shorter; i < longer && shorter * i < longer * (x + 1); ++i) {
      const int64_t weight =
          std::min(longer * (x + 1), shorter * (i + 1)) - std::max(longer * x, shorter * i);
      if (weight > 0) all[static_cast<size_t>(x)].push_back({static_cast<int>(i), weight});
    }
  return all;
}

}  // namespace

cv::Mat shrink(const cv::Mat& grey, int width, int height) {
  const auto columns = shares(grey.cols, width);
  const auto rows = shares(grey.rows, height);
  const int64_t area = int64_t{grey.cols} * grey.rows;
  cv::Mat out(height, width, CV_8U);
  std::vector<int64_t> sums(static_cast<size_t>(width));
  for (int y = 0; y < height; ++y) {
    std::fill(sums.begin(), sums.end(), 0);
    for (const Share& row : rows[static_cast<size_t>(y)]) {
      const uint8_t* from = grey.ptr<uint8_t>(row.from);
      for (size_t x = 0; x < sums.size(); ++x) {
        int64_t sum = 0;
        for (const Share& column : columns[x]) sum += column.weight * from[column.from];
        sums[x] += row.weight * sum;
      }
    }
    for (size_t x = 0; x < sums.size(); ++x)
      out.at<uint8_t>(y, static_cast<int>(x)) =
          static_cast<uint8_t>((2 * sums[x] + area) / (2 * area));
  }
  return out;
}

}  // namespace vpr
