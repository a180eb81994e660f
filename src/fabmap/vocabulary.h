// Visual words: local features quantized by a vocabulary (Sivic & Zisserman; FAB-MAP), the words of
// views, and the inverted index from words to views.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace vpr {

/// The visual words of a frame or view: word ids, increasing, without duplicates.
using WordSet = std::vector<uint32_t>;

/// Centers per block of CenterBlocks.
inline constexpr size_t kCenterLanes = 32;

/// Centers in blocks of 32, stored by dimension, so that each SIMD lane is one center.
struct CenterBlocks {
  size_t dims = 0;
  std::vector<float> values;      ///< by block, dimension, lane
  std::vector<float> half_norms;  ///< |c|^2 / 2; infinite in the padding
};

/// One row per word: CV_32F, compared by Euclidean distance, or CV_8U, by Hamming distance.
struct Vocabulary {
  cv::Mat words;
  CenterBlocks blocks;  ///< of float words
};

/// The vocabulary of words, one per row. `words` is CV_32F or CV_8U with at least one row. Does not
/// throw.
Vocabulary make_vocabulary(const cv::Mat& words);

/// |p - c|^2 / 2 - |p|^2 / 2 of the nearest center c of point p: smaller is nearer.
struct NearestCenter {
  float score = 0;
  uint32_t center = 0;
};

/// The nearest word of each of the given rows of `descriptors` (exact; ties to the lower word),
/// which have the type and length of words. The score of bits is the Hamming distance. The score of
/// floats is a chain of fused multiply-adds over the dimensions in order, rounded according to IEEE
/// 754 on every target. Scores depend only on the descriptor and the word; a descriptor with a NaN
/// gets word 0.
std::vector<NearestCenter> find_nearest_words(const Vocabulary& vocabulary,
                                              const cv::Mat& descriptors,
                                              std::span<const uint32_t> rows);

std::vector<uint32_t> nearest_words(const Vocabulary& vocabulary, const cv::Mat& descriptors);

/// The set of the nearest words; empty if there are no descriptors.
WordSet quantize(const Vocabulary& vocabulary, const cv::Mat& descriptors);

/// Word sets of consecutive views: view v has words[offsets[v]] .. words[offsets[v+1]].
struct ViewWords {
  std::vector<uint64_t> offsets = {0};
  std::vector<uint32_t> words;

  size_t views() const { return offsets.size() - 1; }
  std::span<const uint32_t> view(size_t v) const {
    return {words.data() + offsets[v], static_cast<size_t>(offsets[v + 1] - offsets[v])};
  }
  void add(std::span<const uint32_t> view_words) {
    words.insert(words.end(), view_words.begin(), view_words.end());
    offsets.push_back(words.size());
  }
};

/// Views are stored in blocks of 65536: two bytes identify a view within its block, and the sums of
/// a block stay in a cache.
inline constexpr size_t kIndexBlock = 65536;

/// For every word, the views that show it, in blocks of kIndexBlock views.
struct WordIndex {
  size_t words = 0;
  size_t views = 0;
  std::vector<uint64_t> offsets = {0};  ///< blocks x words + 1, block by block
  std::vector<uint16_t> lists;          ///< indices within the block, increasing

  size_t blocks() const { return (views + kIndexBlock - 1) / kIndexBlock; }
  /// The views of a block that show a word, minus block * kIndexBlock.
  std::span<const uint16_t> list(size_t block, size_t word) const {
    const uint64_t* at = offsets.data() + block * words + word;
    return {lists.data() + at[0], static_cast<size_t>(at[1] - at[0])};
  }
};

/// Every word of every view is below `words`.
WordIndex make_word_index(const ViewWords& views, size_t words);

/// Whether all offsets and lists stay within the views.
bool is_valid_index(const WordIndex& index);

}  // namespace vpr
