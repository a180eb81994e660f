// Visual words: local features quantised by a vocabulary (Sivic & Zisserman; FAB-MAP).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "describe/descriptor_rows.h"
#include "fabmap/local_features.h"
#include "fabmap/nearest_centre.h"

namespace vpr {

/// One row a word: CV_32F, compared by Euclidean distance, or CV_8U, by Hamming distance.
struct Vocabulary {
  cv::Mat words;
  CentreBlocks blocks;  ///< of float words
};

/// The vocabulary of words, one a row. It throws nothing; `words` is CV_32F or CV_8U with at least
/// one row.
Vocabulary make_vocabulary(const cv::Mat& words);

/// The nearest word of each of the given rows of `descriptors` (exact; ties to the lower word),
/// which have the type and length of words. The score of floats is that of find_nearest_centres, of
/// bits the Hamming distance; it depends on the descriptor and the word alone.
void find_nearest_words(const Vocabulary& vocabulary, const cv::Mat& descriptors,
                        std::span<const uint32_t> rows, NearestCentre* nearest);

/// The nearest word of every descriptor.
std::vector<uint32_t> nearest_words(const Vocabulary& vocabulary, const cv::Mat& descriptors);

/// The set of the nearest words; empty for no descriptors.
WordSet quantise(const Vocabulary& vocabulary, const cv::Mat& descriptors);

/// Bits in which two byte strings differ.
uint32_t hamming_bytes(const uint8_t* a, const uint8_t* b, size_t bytes);

}  // namespace vpr
