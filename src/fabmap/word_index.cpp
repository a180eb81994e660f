#include "fabmap/word_index.h"

#include <algorithm>
#include <numeric>

namespace vpr {

WordIndex make_word_index(const ViewWords& views, size_t words) {
  WordIndex index;
  index.words = words;
  index.views = views.views();
  index.offsets.assign(index.blocks() * words + 1, 0);
  const auto for_each = [&](auto&& visit) {
    for (size_t v = 0; v < index.views; ++v)
      for (const uint32_t word : views.view(v)) visit(v / kIndexBlock * words + word, v);
  };
  for_each([&](size_t list, size_t) { ++index.offsets[list + 1]; });
  std::partial_sum(index.offsets.begin(), index.offsets.end(), index.offsets.begin());
  index.lists.resize(views.words.size());
  std::vector<uint64_t> at(index.offsets.begin(), index.offsets.end() - 1);
  for_each([&](size_t list, size_t v) {
    index.lists[at[list]++] = static_cast<uint16_t>(v % kIndexBlock);
  });
  return index;
}

bool is_sound(const WordIndex& index) {
  if (index.offsets.size() != index.blocks() * index.words + 1 || index.offsets.front() != 0 ||
      index.offsets.back() != index.lists.size() ||
      !std::is_sorted(index.offsets.begin(), index.offsets.end()))
    return false;
  for (size_t block = 0; block < index.blocks(); ++block) {
    for (size_t word = 0; word < index.words; ++word) {
      const auto list = index.list(block, word);
      if (!list.empty() &&
          (list.back() >= index.block_views(block) ||
           std::adjacent_find(list.begin(), list.end(), std::greater_equal<>()) != list.end()))
        return false;
    }
  }
  return true;
}

}  // namespace vpr
