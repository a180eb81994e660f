// Visual words: local features quantized by a vocabulary (Sivic & Zisserman; FAB-MAP).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "describe/descriptor_rows.h"
#include "fabmap/local_features.h"
#include "fabmap/nearest_center.h"

namespace vpr {

/// One row per word: CV_32F, compared by Euclidean distance, or CV_8U, by Hamming distance.
struct Vocabulary {
  cv::Mat words;
  CenterBlocks blocks;  ///< of float words
};

/// The vocabulary of words, one per row. `words` is CV_32F or CV_8U with at least one row. Does not
/// throw.
Vocabulary make_vocabulary(const cv::Mat& words);

/// The nearest word of each of the given rows of `descriptors` (exact; ties to the lower word),
/// which have the type and length of words. The score is the score of find_nearest_centers for
/// floats and the Hamming distance for bits; it depends only on the descriptor and the word.
void find_nearest_words(const Vocabulary& vocabulary, const cv::Mat& descriptors,
                        std::span<const uint32_t> rows, NearestCenter* nearest);

std::vector<uint32_t> nearest_words(const Vocabulary& vocabulary, const cv::Mat& descriptors);

/// The set of the nearest words; empty if there are no descriptors.
WordSet quantize(const Vocabulary& vocabulary, const cv::Mat& descriptors);

/// The number of different bits.
uint32_t hamming_bytes(const uint8_t* a, const uint8_t* b, size_t bytes);

}  // namespace vpr
