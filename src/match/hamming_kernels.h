// The inner loops of Hamming distances, compiled once for every SIMD target and chosen at run time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "match/frame_distances.h"

namespace vpr {

/// One word of eight frames: a SIMD lane is a frame, so that nothing is summed across lanes. The
/// words of a block of eight frames lie one after the other.
struct alignas(64) LaneWords {
  std::array<uint64_t, kStretchFrames> frames;
};

/// Kernels of codes of a number of words of 64 bits. All targets give the same integers.
struct HammingKernels {
  /// Writes a code's words as the tile takes them, of query and training frames alike.
  void (*encode)(const uint8_t* code, size_t words, uint64_t* out);
  /// out[t * out_stride + i] = Hamming distance of query frame t to frame i of the blocks;
  /// 8 * block_count values a query frame. Query frames lie one after the other.
  void (*tile)(const uint64_t* queries, size_t query_count, size_t words, const LaneWords* blocks,
               size_t block_count, uint16_t* out, size_t out_stride);
};

/// The kernels of the SIMD target in use (base/simd.h): those of LDB for its 22 words, else a loop.
HammingKernels select_hamming_kernels(size_t words);

}  // namespace vpr
