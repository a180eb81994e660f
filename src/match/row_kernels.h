// The inner loops over rows of distances, compiled once per SIMD target and dispatched at run time
// (base/simd.h). All targets give the same integers. Called per row or tile, never per pair.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vpr {

/// after[x] = before[x] + entering[x] - leaving[x]: FastABLE's recurrence (paper, section VII).
/// `before` and `after` are the same array or do not overlap.
void slide_sums(const uint32_t* before, const uint16_t* entering, const uint16_t* leaving,
                uint32_t* after, size_t count);

/// sums[x] += entering[x].
void add_to_sums(std::span<uint32_t> sums, const uint16_t* entering);

/// The smallest and the largest value; there is at least one.
uint32_t minimum_of(std::span<const uint32_t> values);
uint32_t maximum_of(std::span<const uint32_t> values);

/// The first index from `begin` on whose value is below `limit` (strict), or the size.
size_t find_below(std::span<const uint32_t> values, size_t begin, uint32_t limit);

}  // namespace vpr
