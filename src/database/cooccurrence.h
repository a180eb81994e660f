// How often words occur together, from columns of bits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "descriptors/vocabulary.h"

namespace vpr {

/// Bit f % 64 of bits[(f / 64) * padded_words + q]: frame f shows word q.
struct WordColumns {
  size_t chunks = 0;        ///< of 64 frames
  size_t padded_words = 0;  ///< a multiple of 16; the padding occurs nowhere
  std::vector<uint64_t> bits;
};

WordColumns make_word_columns(std::span<const WordSet> frames, size_t words);

/// Frames that show both words.
size_t count_both(const WordColumns& columns, size_t a, size_t b);

/// out[v] = frames that show both `word` and v, for every v below padded_words.
void count_both_with_all(const WordColumns& columns, size_t word, uint32_t* out);

}  // namespace vpr
