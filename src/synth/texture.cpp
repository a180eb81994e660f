#include "synth/texture.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace vpr {

Texture make_texture(const cv::Mat& level_0) {
  Texture texture;
  texture.levels.push_back(level_0);
  while (true) {
    const cv::Mat& last = texture.levels.back();
    if (last.rows < 2 || last.cols < 2) return texture;
    cv::Mat half;
    cv::resize(last, half, {last.cols / 2, last.rows / 2}, 0, 0, cv::INTER_AREA);
    texture.levels.push_back(half);
  }
}

Texture make_wall_texture(const cv::Mat& picture) {
  cv::Mat turned;
  cv::transpose(picture, turned);
  return make_texture(turned);
}

size_t choose_level(const Texture& texture, double texels) {
  size_t level = 0;
  while (level + 1 < texture.levels.size() && texels > 1.4) {
    texels /= 2;
    ++level;
  }
  return level;
}

void filter_strip(const Texture& texture, size_t level, double centre, double width,
                  std::vector<cv::Vec4b>& strip) {
  constexpr double kMostTexels = 24;  // a wall seen almost from its edge: one pixel, a few strips
  const cv::Mat& image = texture.levels[level];
  const double scale = static_cast<double>(image.rows) / texture.levels[0].rows;
  const double extent = std::clamp(width * scale, 1.0, kMostTexels);
  const double low = std::clamp(centre * scale - extent / 2, -1e6, 1e6);
  const int first = static_cast<int>(std::floor(low));
  const int last = static_cast<int>(std::ceil(low + extent)) - 1;
  const auto pixels = static_cast<size_t>(image.cols);
  thread_local std::vector<uint32_t> sums;
  sums.assign(pixels * 4, 0);
  uint32_t weights = 0;
  for (int row = first; row <= last; ++row) {
    const double covered = std::min(row + 1.0, low + extent) - std::max<double>(row, low);
    const auto weight = static_cast<uint32_t>(std::lround(covered * 256));
    const uint8_t* texels = image.ptr<uint8_t>(std::clamp(row, 0, image.rows - 1));
    for (size_t i = 0; i < pixels * 4; ++i) sums[i] += weight * texels[i];
    weights += weight;
  }
  strip.resize(pixels);
  const uint32_t factor = (1u << 24) / weights;  // at most 24 * 256 * 255 * factor: below 2^32
  auto* bytes = reinterpret_cast<uint8_t*>(strip.data());
  for (size_t i = 0; i < pixels * 4; ++i)
    bytes[i] = static_cast<uint8_t>((sums[i] * factor + (1u << 23)) >> 24);
}

}  // namespace vpr
