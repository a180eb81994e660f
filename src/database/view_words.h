// The word sets of many views, as databases keep them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "descriptors/word_set.h"

namespace vpr {

/// Word sets of many views, one after the other: view v has words[offsets[v]] ..
/// words[offsets[v+1]].
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

}  // namespace vpr
