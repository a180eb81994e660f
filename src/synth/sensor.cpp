#include "synth/sensor.h"

#include <array>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

namespace vpr {
namespace {

constexpr int kMostBlur = 31;
constexpr size_t kNoiseValues = size_t{1} << 16;
constexpr int kNoiseUnit = 64;  // one standard deviation

// Sums of twelve uniform numbers: near enough to normal ones, and the same everywhere.
const std::array<int16_t, kNoiseValues>& noise_values() {
  static const auto kValues = [] {
    std::array<int16_t, kNoiseValues> values;
    RandomEngine engine = named_engine(0, "sensor noise");
    for (int16_t& value : values) {
      double sum = -6;
      for (int i = 0; i < 12; ++i) sum += uniform_unit(engine);
      value = static_cast<int16_t>(std::lround(sum * kNoiseUnit));
    }
    return values;
  }();
  return kValues;
}

}  // namespace

void blur_by_turning(cv::Mat& picture, double sideways, double upwards) {
  const auto odd = [](double pixels) {  // so that nothing is shifted
    const double way = std::min<double>(kMostBlur, std::abs(pixels));
    return 2 * static_cast<int>(std::lround((way - 1) / 2)) + 1;
  };
  const cv::Size size(std::max(1, odd(sideways)), std::max(1, odd(upwards)));
  if (size.area() > 1) cv::blur(picture, picture, size);
}

void add_noise(cv::Mat& picture, double deviation, RandomEngine& engine) {
  const auto& values = noise_values();
  const int factor = static_cast<int>(std::lround(deviation * 256));
  const size_t bytes = static_cast<size_t>(picture.cols) * 3;
  for (int y = 0; y < picture.rows; ++y) {
    uint8_t* row = picture.ptr<uint8_t>(y);
    size_t from = engine();  // another stretch of the values for each row
    for (size_t i = 0; i < bytes; ++i) {
      const int noise = values[(from + i) % kNoiseValues] * factor / (256 * kNoiseUnit);
      row[i] = cv::saturate_cast<uint8_t>(row[i] + noise);
    }
  }
}

}  // namespace vpr
