#include "database/whole_frame.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

#include "database/imported.h"

namespace vpr {
namespace {

constexpr int kLdbSide = 64;
constexpr int kLdbBorder = 3;
constexpr int kLdbWindow = 60;

/// A pixel of the longer line, and its overlap with a pixel of the shorter line.
struct Share {
  int from = 0;
  int64_t weight = 0;
};

// In units in which the pixels of both lines have integer lengths: pixel x of the `shorter` line
// covers [longer x, longer (x + 1)), pixel i of the `longer` line covers [shorter i, shorter (i +
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

constexpr double kDeviation = 32;  // gray levels

void normalize_square(const cv::Mat& small, int left, int top, Thumbnail64& out) {
  const cv::Mat_<uint8_t> square = small(cv::Rect(left, top, kThumbnailPatch, kThumbnailPatch));
  constexpr int kPixels = kThumbnailPatch * kThumbnailPatch;
  int sum = 0;
  int squares = 0;
  for (const int level : square) {
    sum += level;
    squares += level * level;
  }
  // 64 times the deviation of 64 p - sum: the root of 64 squares - sum^2.
  const double deviation = std::sqrt(static_cast<double>(kPixels * squares - sum * sum));
  for (int y = 0; y < kThumbnailPatch; ++y)
    for (int x = 0; x < kThumbnailPatch; ++x) {
      const double level =
          deviation > 0 ? 128 + kDeviation * (kPixels * square(y, x) - sum) / deviation : 128;
      out[static_cast<size_t>(top + y) * kThumbnailWidth + static_cast<size_t>(left + x)] =
          static_cast<uint8_t>(std::clamp(std::nearbyint(level), 0.0, 255.0));
    }
}

constexpr double kAlpha = 0.47;

cv::Mat resized(const cv::Mat& gray, int side) {
  assert(gray.type() == CV_8UC1 && !gray.empty());
  cv::Mat square;
  cv::resize(gray, square, {side, side}, 0, 0, cv::INTER_LINEAR_EXACT);
  return square;
}

constexpr int kHogSide = 64;
constexpr int kHogCell = 16;
constexpr size_t kHogCells = kHogSide / kHogCell;  // per side
constexpr size_t kHogDirections = 8;
// Unit vectors of the directions, 22.5 degrees apart, from 11.25 degrees on.
constexpr std::array<std::array<double, 2>, kHogDirections> kHogAxes = {
    {{0.98078528040323044, 0.19509032201612827},
     {0.83146961230254524, 0.55557023301960222},
     {0.55557023301960222, 0.83146961230254524},
     {0.19509032201612827, 0.98078528040323044},
     {-0.19509032201612827, 0.98078528040323044},
     {-0.55557023301960222, 0.83146961230254524},
     {-0.83146961230254524, 0.55557023301960222},
     {-0.98078528040323044, 0.19509032201612827}}};
constexpr double kHogNeighbor = 0.92387953251128674;  // cosine of 22.5 degrees

using HogCell = std::array<double, kHogDirections>;
using HogCells = std::array<std::array<HogCell, kHogCells>, kHogCells>;

// The two cells of a line of cells that are next to a pixel, with their shares.
std::array<std::pair<int, double>, 2> cells_near(int pixel) {
  const int twice = 2 * pixel + 1 - kHogCell;  // to the center of the first cell, in half pixels
  const int before = twice < 0 ? -1 : twice / (2 * kHogCell);
  const double share = twice / (2.0 * kHogCell) - before;
  return {{{before, 1 - share}, {before + 1, share}}};
}

// Histograms of the directions of gradients, weighted by their length. A direction's weight is 0
// at the next directions.
HogCells gradient_cells(const cv::Mat_<uint8_t>& image) {
  HogCells cells{};
  const auto at = [&](int y, int x) {
    return int{image(std::clamp(y, 0, kHogSide - 1), std::clamp(x, 0, kHogSide - 1))};
  };
  for (int y = 0; y < kHogSide; ++y)
    for (int x = 0; x < kHogSide; ++x) {
      const double across = at(y, x + 1) - at(y, x - 1);
      const double down = at(y + 1, x) - at(y - 1, x);
      const double length = std::sqrt(across * across + down * down);
      for (size_t k = 0; k < kHogDirections; ++k) {
        const double along = std::abs(across * kHogAxes[k][0] + down * kHogAxes[k][1]);
        const double weight = along - kHogNeighbor * length;
        if (weight <= 0) continue;
        for (const auto& [row, vertical] : cells_near(y))
          for (const auto& [column, horizontal] : cells_near(x))
            if (row >= 0 && column >= 0 && row < int{kHogCells} && column < int{kHogCells})
              cells[static_cast<size_t>(row)][static_cast<size_t>(column)][k] +=
                  weight * vertical * horizontal;
      }
    }
  return cells;
}

void normalize(std::span<double> block) {
  double square = 0;
  for (const double value : block) square += value * value;
  if (square == 0) return;
  const double length = std::sqrt(square);
  for (double& value : block) value /= length;
}

std::vector<double> normalized_blocks(const HogCells& cells) {
  constexpr double kMost = 0.2;
  std::vector<double> blocks;
  for (size_t y = 0; y + 1 < kHogCells; ++y)
    for (size_t x = 0; x + 1 < kHogCells; ++x) {
      const size_t first = blocks.size();
      for (const HogCell& cell :
           {cells[y][x], cells[y][x + 1], cells[y + 1][x], cells[y + 1][x + 1]})
        blocks.insert(blocks.end(), cell.begin(), cell.end());
      const auto block = std::span(blocks).subspan(first);
      normalize(block);
      for (double& value : block) value = std::min(value, kMost);
      normalize(block);
    }
  return blocks;
}

}  // namespace

std::array<std::array<int32_t, 25>, 3> ldb_cell_values(const cv::Mat& integral, int g) {
  const int side = kLdbWindow / g;
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
  cv::Mat blurred;
  cv::GaussianBlur(resized(gray, kLdbSide), blurred, {7, 7}, 2, 2, cv::BORDER_REFLECT_101);
  cv::Mat integral;
  cv::integral(blurred(cv::Rect(kLdbBorder, kLdbBorder, kLdbWindow, kLdbWindow)), integral, CV_32S);
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

cv::Mat shrink(const cv::Mat& gray, int width, int height) {
  const auto columns = shares(gray.cols, width);
  const auto rows = shares(gray.rows, height);
  const int64_t area = int64_t{gray.cols} * gray.rows;
  cv::Mat out(height, width, CV_8U);
  std::vector<int64_t> sums(static_cast<size_t>(width));
  for (int y = 0; y < height; ++y) {
    std::ranges::fill(sums, 0);
    for (const Share& row : rows[static_cast<size_t>(y)]) {
      const uint8_t* from = gray.ptr<uint8_t>(row.from);
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

Thumbnail64 describe_thumbnail(const cv::Mat& gray) {
  const cv::Mat small = shrink(gray, kThumbnailWidth, kThumbnailHeight);
  Thumbnail64 thumbnail;
  for (int y = 0; y < kThumbnailHeight; y += kThumbnailPatch)
    for (int x = 0; x < kThumbnailWidth; x += kThumbnailPatch)
      normalize_square(small, x, y, thumbnail);
  return thumbnail;
}

HogVector describe_hog(const cv::Mat& gray) {
  const std::vector<double> vector = normalized_blocks(gradient_cells(resized(gray, kHogSide)));
  HogVector numbers{};
  if (std::ranges::any_of(vector, [](double value) { return value != 0; }))
    quantize_numbers(vector, std::span(numbers));
  return numbers;
}

LdbHogRow describe_ldb_hog(const cv::Mat& gray) {
  const LdbCode code = describe_ldb(gray);
  const HogVector hog = describe_hog(gray);
  LdbHogRow row;
  std::memcpy(row.data(), code.data(), code.size());
  std::memcpy(row.data() + code.size(), hog.data(), hog.size());
  return row;
}

cv::Mat illumination_invariant(const cv::Mat& bgr) {
  assert(bgr.type() == CV_8UC3);
  static const auto kLn = [] {  // of channels in [0, 1]
    std::array<double, 256> table{};
    for (size_t value = 1; value < table.size(); ++value)
      table[value] = std::log(static_cast<double>(value) / 255);
    return table;
  }();
  cv::Mat gray(bgr.size(), CV_8UC1);
  for (int y = 0; y < bgr.rows; ++y)
    for (int x = 0; x < bgr.cols; ++x) {
      const auto& pixel = bgr.at<cv::Vec3b>(y, x);
      double value = 0.5 + kLn[pixel[1]] - kAlpha * kLn[pixel[0]] - (1 - kAlpha) * kLn[pixel[2]];
      if (value < 0) value = 1;
      gray.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(std::nearbyint(value * 255));
    }
  return gray;
}

}  // namespace vpr
