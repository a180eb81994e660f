// Counts how often words occur together, from columns of bits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fabmap/vocabulary.h"

namespace vpr {

/// Words per block of WordColumns.
inline constexpr size_t kColumnLanes = 16;

/// Consecutive blocks of 16 words, so that all words are counted in one pass.
struct WordColumns {
  size_t chunks = 0;        ///< number of chunks of 64 frames
  size_t padded_words = 0;  ///< a multiple of 16; no frame shows the padding
  std::vector<uint64_t> bits;

  /// Bit f % 64 of bits[at(f / 64, q)] is set if frame f shows word q.
  size_t at(size_t chunk, size_t word) const {
    return (word / kColumnLanes * chunks + chunk) * kColumnLanes + word % kColumnLanes;
  }
};

/// The columns of frames, each with increasing word ids below `words`.
WordColumns make_word_columns(std::span<const WordSet> frames, size_t words);

/// The number of frames that show both words.
size_t count_both(const WordColumns& columns, size_t a, size_t b);

/// out[v] is the number of frames that show both `word` and v, for every v below padded_words.
void count_both_with_all(const WordColumns& columns, size_t word, uint32_t* out);

}  // namespace vpr
