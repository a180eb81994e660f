// The words of many views as stored in databases, and the inverted index from words to views.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "describe/descriptor_rows.h"

namespace vpr {

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
  size_t block_views(size_t block) const {
    return std::min(kIndexBlock, views - block * kIndexBlock);
  }
  /// The views of a block that show a word, minus block * kIndexBlock.
  std::span<const uint16_t> list(size_t block, size_t word) const {
    const uint64_t* at = offsets.data() + block * words + word;
    return {lists.data() + at[0], static_cast<size_t>(at[1] - at[0])};
  }
};

/// Every word of every view is below `words`.
WordIndex make_word_index(const ViewWords& views, size_t words);

/// Whether all offsets and lists stay within the views.
bool is_sound(const WordIndex& index);

}  // namespace vpr
