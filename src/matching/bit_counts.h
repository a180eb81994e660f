// How many codes of a set have each bit: sums of distances to the whole set without looking at it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "descriptors/descriptor_rows.h"

namespace vpr {

/// How many frames have each bit.
struct BitCounts {
  size_t frames = 0;
  std::vector<uint32_t> ones;  ///< frames that have the bit, for every bit of a row, with padding
  int64_t total = 0;           ///< their sum
};

/// Readable frames of all sequences, whose rows have `row_bytes` bytes. Fewer than 2^32 frames.
BitCounts count_bits(std::span<const DescriptorSpan> sequences, size_t row_bytes);

/// Bits in which the code differs from those that were counted, over all of them.
uint64_t distance_sum(const BitCounts& counts, DescriptorRow code);

}  // namespace vpr
