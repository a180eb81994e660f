// How often words occur together, from columns of bits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fabmap/vocabulary.h"

namespace vpr {

/// Words of a block of WordColumns.
inline constexpr size_t kColumnLanes = 16;

/// Words in blocks of 16 that lie one after the other, so that all words are counted in one pass.
struct WordColumns {
  size_t chunks = 0;        ///< of 64 frames
  size_t padded_words = 0;  ///< a multiple of 16; the padding occurs nowhere
  std::vector<uint64_t> bits;

  /// Bit f % 64 of bits[at(f / 64, q)]: frame f shows word q.
  size_t at(size_t chunk, size_t word) const {
    return (word / kColumnLanes * chunks + chunk) * kColumnLanes + word % kColumnLanes;
  }
};

/// The columns of frames, each given by its word ids below `words`, rising.
WordColumns make_word_columns(std::span<const WordSet> frames, size_t words);

/// Frames that show both words.
size_t count_both(const WordColumns& columns, size_t a, size_t b);

/// out[v] = frames that show both `word` and v, for every v below padded_words.
void count_both_with_all(const WordColumns& columns, size_t word, uint32_t* out);

}  // namespace vpr
