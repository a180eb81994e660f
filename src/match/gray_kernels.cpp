// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "base/highway.h"
// The settings above must come first.
#include <cstdlib>

#include "match/gray_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/gray_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR  // one lane, without bytes

uint32_t Differences(const uint8_t* a, const uint8_t* b, size_t length) {
  uint32_t sum = 0;
  for (size_t i = 0; i < length; ++i) sum += static_cast<uint32_t>(std::abs(a[i] - b[i]));
  return sum;
}

#else

HWY_INLINE uint32_t Differences(const uint8_t* HWY_RESTRICT a, const uint8_t* HWY_RESTRICT b,
                                size_t length) {
  const hn::CappedTag<uint8_t, kGrayPixels> d;
  const hn::Repartition<uint64_t, decltype(d)> d64;
  auto sums = hn::Zero(d64);
  for (size_t i = 0; i < length; i += hn::Lanes(d)) {
    const auto left = hn::LoadU(d, a + i);
    const auto right = hn::LoadU(d, b + i);
    sums = hn::Add(sums, hn::SumsOf8(hn::Sub(hn::Max(left, right), hn::Min(left, right))));
  }
  return static_cast<uint32_t>(hn::GetLane(hn::SumOfLanes(d64, sums)));
}

#endif

// A row stays in the nearest cache for all query frames.
void Tile(std::span<const uint8_t* const> queries, const uint8_t* rows, size_t row_count,
          size_t length, uint32_t* out) {
  for (size_t i = 0; i < row_count; ++i)
    for (size_t t = 0; t < queries.size(); ++t)
      out[t * row_count + i] = Differences(queries[t], rows + i * length, length);
}

}  // namespace

GrayKernels Grays() { return {Tile}; }

}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(Grays);

GrayKernels select_gray_kernels() { return HWY_DYNAMIC_DISPATCH(Grays)(); }

}  // namespace vpr

#endif  // HWY_ONCE
