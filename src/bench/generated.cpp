#include "bench/generated.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "base/random.h"
#include "database/imported.h"

namespace vpr {
namespace {

constexpr size_t kChangedBits = 60;

void flip_bits(LdbCode& code, size_t count, RandomEngine& engine) {
  for (size_t i = 0; i < count; ++i) {
    const size_t bit = uniform_below(engine, kLdbBits);
    code[bit / 8] = static_cast<uint8_t>(code[bit / 8] ^ (1U << bit % 8));
  }
}

}  // namespace

std::vector<LdbCode> generate_sequence(size_t count, uint64_t seed) {
  RandomEngine engine(seed);
  std::vector<LdbCode> codes(count);
  LdbCode code{};
  flip_bits(code, kLdbBits, engine);
  for (LdbCode& next : codes) {
    flip_bits(code, kChangedBits, engine);
    next = code;
  }
  return codes;
}

std::vector<LdbCode> repeat_sequence(const std::vector<LdbCode>& walk, size_t first, size_t count,
                                     size_t changed_bits, uint64_t seed) {
  RandomEngine engine(seed);
  std::vector<LdbCode> codes;
  for (size_t i = 0; i < count; ++i) {
    codes.push_back(walk[(first + i) % walk.size()]);
    flip_bits(codes.back(), changed_bits, engine);
  }
  return codes;
}

GeneratedVectors generate_vectors(size_t count, size_t length, size_t bits, uint64_t seed,
                                  uint64_t noise_seed, size_t first) {
  GeneratedVectors vectors;
  vectors.shape = {bits == 8 ? ElementType::int8 : ElementType::int16, length};
  RandomEngine engine(seed);
  RandomEngine noise(noise_seed);
  std::vector<double> place(length, 0);
  std::vector<double> seen(length);
  std::vector<uint8_t> row(vectors.shape.row_bytes());
  for (size_t i = 0; i < first + count; ++i) {
    for (size_t x = 0; x < length; ++x) place[x] = 0.9 * place[x] + uniform_unit(engine) - 0.5;
    if (i < first) continue;
    for (size_t x = 0; x < length; ++x) seen[x] = place[x] + 0.3 * (uniform_unit(noise) - 0.5);
    if (bits == 8)
      quantize_numbers(seen, std::span(reinterpret_cast<int8_t*>(row.data()), length));
    else
      quantize_numbers(seen, std::span(reinterpret_cast<int16_t*>(row.data()), length));
    vectors.bytes.insert(vectors.bytes.end(), row.begin(), row.end());
  }
  return vectors;
}

cv::Mat generate_frame(uint64_t seed) {
  RandomEngine engine(seed);
  const auto below = [&](int most) {
    return static_cast<int>(uniform_below(engine, static_cast<uint64_t>(most)));
  };
  cv::Mat frame(480, 640, CV_8UC1);
  for (int r = 0; r < frame.rows; ++r)
    for (int c = 0; c < frame.cols; ++c)
      frame.at<uint8_t>(r, c) = static_cast<uint8_t>(90 + r / 8 + c / 16);
  for (int i = 0; i < 60; ++i) {
    const cv::Point corner(below(640), below(480));
    const cv::Size size(10 + below(90), 10 + below(70));
    cv::rectangle(frame, cv::Rect(corner, size), cv::Scalar(below(256)), below(2) == 0 ? -1 : 2);
    cv::line(frame, corner, {below(640), below(480)}, cv::Scalar(below(256)), 1 + below(3));
  }
  cv::Mat noise(frame.size(), CV_8UC1);
  for (int r = 0; r < noise.rows; ++r)
    for (int c = 0; c < noise.cols; ++c) noise.at<uint8_t>(r, c) = static_cast<uint8_t>(below(12));
  frame += noise;
  cv::GaussianBlur(frame, frame, {3, 3}, 0.8);
  return frame;
}

WordSet generate_words(size_t words, size_t per_frame, uint64_t seed) {
  RandomEngine engine(seed);
  WordSet set;
  for (size_t i = 0; i < per_frame; ++i)
    set.push_back(static_cast<uint32_t>(uniform_below(engine, words)));
  std::sort(set.begin(), set.end());
  set.erase(std::unique(set.begin(), set.end()), set.end());
  return set;
}

}  // namespace vpr
