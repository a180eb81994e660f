#include "describe/ldb.h"

#include <cassert>

#include <opencv2/imgproc.hpp>

namespace vpr {
namespace {

constexpr int kResized = 64;
constexpr int kBorder = 3;
constexpr int kWindow = 60;

cv::Mat ldb_window(const cv::Mat& gray) {
  cv::Mat resized;
  cv::resize(gray, resized, cv::Size(kResized, kResized), 0, 0, cv::INTER_LINEAR_EXACT);
  cv::Mat blurred;
  cv::GaussianBlur(resized, blurred, cv::Size(7, 7), 2, 2, cv::BORDER_REFLECT_101);
  return blurred(cv::Rect(kBorder, kBorder, kWindow, kWindow));
}

}  // namespace

std::array<std::array<int32_t, 25>, 3> ldb_cell_values(const cv::Mat& integral, int g) {
  const int side = kWindow / g;
  const int half = (side - 1) / 2;
  const auto sum = [&](int top, int left, int bottom, int right) {
    const int* above = integral.ptr<int>(top);
    const int* below = integral.ptr<int>(bottom);
    return below[right] - below[left] - above[right] + above[left];
  };
  std::array<std::array<int32_t, 25>, 3> values{};
  for (int r = 0; r < g; ++r) {
    for (int c = 0; c < g; ++c) {
      const int top = r * side + 1;
      const int left = c * side + 1;
      const int bottom = (r + 1) * side;
      const int right = (c + 1) * side;
      const int all = sum(top, left, bottom, right);
      const auto cell = static_cast<size_t>(r) * static_cast<size_t>(g) + static_cast<size_t>(c);
      values[0][cell] = all;
      values[1][cell] = all - 2 * sum(top, left, bottom, left + half);
      values[2][cell] = all - 2 * sum(top, left, top + half, right);
    }
  }
  return values;
}

LdbCode describe_ldb(const cv::Mat& gray) {
  assert(gray.type() == CV_8UC1 && !gray.empty());
  cv::Mat integral;
  cv::integral(ldb_window(gray), integral, CV_32S);
  LdbCode code{};
  size_t bit = 0;
  for (int g = 2; g <= 5; ++g) {
    const auto values = ldb_cell_values(integral, g);
    const size_t cells = static_cast<size_t>(g) * static_cast<size_t>(g);
    for (size_t i = 0; i < cells; ++i) {
      for (size_t j = i + 1; j < cells; ++j) {
        for (size_t k = 0; k < 3; ++k, ++bit) {
          const int set = values[k][i] > values[k][j] ? 1 : 0;
          code[bit / 8] = static_cast<uint8_t>(code[bit / 8] | set << (bit % 8));
        }
      }
    }
  }
  assert(bit == kLdbBits);
  return code;
}

}  // namespace vpr
