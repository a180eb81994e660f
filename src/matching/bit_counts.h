// How many codes of a set have each bit: mean distances to the whole set without looking at it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "matching/codes.h"

namespace vpr {

struct BitCounts {
  size_t frames = 0;
  std::array<uint32_t, kLdbBytes* 8> ones = {};  ///< frames that have the bit
};

/// Readable frames of all sequences. Fewer than 2^32 frames.
BitCounts count_bits(std::span<const CodeSpan> sequences);

/// The counts of the same set without these frames.
BitCounts without(const BitCounts& all, const BitCounts& some);

/// For every window of the query, named by its first frame: the mean distances of its frames to the
/// codes that were counted, summed over the window. A frame that can't be read counts like any
/// other. Zeros where none was counted; empty where the query is shorter than a window.
std::vector<double> mean_window_distances(const BitCounts& counts, std::span<const LdbCode> query,
                                          size_t window_length);

/// Mean Hamming distance of a code to the codes that were counted: their sum, exact, divided once.
/// 0 where none was counted.
double mean_distance(const BitCounts& counts, const CodeWords& code);

/// Mean Hamming distance of a frame of one set to a frame of the other, over all pairs. 0 where
/// either is empty.
double mean_distance_between(const BitCounts& a, const BitCounts& b);

/// Mean Hamming distance of two different frames of a set, over all pairs. 0 of fewer than two.
double mean_distance_within(const BitCounts& counts);

}  // namespace vpr
