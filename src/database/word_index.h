// An inverted index: which views show a word. FAB-MAP's queries touch nothing else of the views.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "database/view_words.h"

namespace vpr {

/// Views in blocks of 65536, so that two bytes name one, and the sums of a block stay in a cache.
inline constexpr size_t kIndexBlock = 65536;

/// For every word the views that show it, by blocks of kIndexBlock views.
struct WordIndex {
  size_t words = 0;
  size_t views = 0;
  std::vector<uint64_t> offsets = {0};  ///< blocks x words + 1, block by block
  std::vector<uint16_t> lists;          ///< views within their block, rising

  size_t blocks() const { return (views + kIndexBlock - 1) / kIndexBlock; }
  size_t block_views(size_t block) const {
    return std::min(kIndexBlock, views - block * kIndexBlock);
  }
  /// The views of a block that show a word, less block * kIndexBlock.
  std::span<const uint16_t> list(size_t block, size_t word) const {
    const uint64_t* at = offsets.data() + block * words + word;
    return {lists.data() + at[0], static_cast<size_t>(at[1] - at[0])};
  }
};

/// Every word of every view is below `words`.
WordIndex make_word_index(const ViewWords& views, size_t words);

/// Whether all offsets and lists can be followed without leaving the views.
bool is_sound(const WordIndex& index);

}  // namespace vpr
