// The inner loops of Hamming distances, compiled once per SIMD target and selected at run time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "match/frame_distances.h"

namespace vpr {

/// One word of eight frames. Each SIMD lane is one frame, which avoids sums across lanes. The words
/// of a block of eight frames are contiguous.
struct alignas(64) LaneWords {
  std::array<uint64_t, kBlockFrames> frames;
};

/// Kernels for codes with a number of 64-bit words. All targets give the same integers.
struct HammingKernels {
  /// Converts the words of a query or training code to the format of the tile.
  void (*encode)(const uint8_t* code, size_t words, uint64_t* out);
  /// out[t * out_stride + i] = Hamming distance of query frame t to frame i of the blocks; 8 *
  /// block_count values per query frame. Query frames are contiguous.
  void (*tile)(const uint64_t* queries, size_t query_count, size_t words, const LaneWords* blocks,
               size_t block_count, uint16_t* out, size_t out_stride);
};

/// The kernels for the current SIMD target (base/simd.h): those of LDB for 22 words, otherwise a
/// loop.
HammingKernels select_hamming_kernels(size_t words);

}  // namespace vpr
