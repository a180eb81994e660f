#include "fabmap/vocabulary.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <numeric>

#include <opencv2/core/mat.hpp>

#include "base/json.h"

namespace vpr {
namespace {

MatrixView<const float> view_of(const cv::Mat& mat) {
  assert(mat.type() == CV_32F);
  MatrixView<const float> view(mat.ptr<float>(), static_cast<size_t>(mat.rows),
                               static_cast<size_t>(mat.cols));
  view.stride = mat.step1();
  return view;
}

NearestCenter nearest_binary_word(const cv::Mat& words, const uint8_t* descriptor) {
  uint32_t nearest = 0;
  uint32_t least = ~0U;
  for (int w = 0; w < words.rows; ++w) {
    const uint32_t distance =
        hamming_bytes(words.ptr(w), descriptor, static_cast<size_t>(words.cols));
    if (distance >= least) continue;
    least = distance;
    nearest = static_cast<uint32_t>(w);
  }
  return {static_cast<float>(least), nearest};
}

}  // namespace

uint32_t hamming_bytes(const uint8_t* a, const uint8_t* b, size_t bytes) {
  uint32_t distance = 0;
  size_t i = 0;
  for (; i + 8 <= bytes; i += 8) {
    uint64_t x = 0;
    uint64_t y = 0;
    std::memcpy(&x, a + i, 8);
    std::memcpy(&y, b + i, 8);
    distance += static_cast<uint32_t>(std::popcount(x ^ y));
  }
  for (; i < bytes; ++i)
    distance += static_cast<uint32_t>(std::popcount(static_cast<uint8_t>(a[i] ^ b[i])));
  return distance;
}

Vocabulary make_vocabulary(const cv::Mat& words) {
  assert(words.rows > 0);
  Vocabulary vocabulary{words, {}};
  if (words.type() == CV_32F) vocabulary.blocks = make_center_blocks(view_of(words));
  return vocabulary;
}

void find_nearest_words(const Vocabulary& vocabulary, const cv::Mat& descriptors,
                        std::span<const uint32_t> rows, NearestCenter* nearest) {
  assert(descriptors.type() == vocabulary.words.type());
  assert(descriptors.cols == vocabulary.words.cols);
  if (descriptors.type() == CV_32F) {
    std::vector<const float*> points;
    for (const uint32_t row : rows) points.push_back(descriptors.ptr<float>(static_cast<int>(row)));
    find_nearest_centers(vocabulary.blocks, points, nearest);
  } else {
    for (size_t i = 0; i < rows.size(); ++i)
      nearest[i] =
          nearest_binary_word(vocabulary.words, descriptors.ptr(static_cast<int>(rows[i])));
  }
}

std::vector<uint32_t> nearest_words(const Vocabulary& vocabulary, const cv::Mat& descriptors) {
  std::vector<uint32_t> words(static_cast<size_t>(descriptors.rows));
  std::iota(words.begin(), words.end(), 0U);
  std::vector<NearestCenter> nearest(words.size());
  find_nearest_words(vocabulary, descriptors, words, nearest.data());
  for (size_t i = 0; i < words.size(); ++i) words[i] = nearest[i].center;
  return words;
}

WordSet quantize(const Vocabulary& vocabulary, const cv::Mat& descriptors) {
  WordSet words = nearest_words(vocabulary, descriptors);
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

}  // namespace vpr
