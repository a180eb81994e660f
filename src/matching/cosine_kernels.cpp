// Compiled several times, once for each SIMD target: see Highway's foreach_target.h.
#include "base/highway.h"
// The settings above come first.
#include "matching/cosine_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/cosine_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

int32_t Product(const int8_t* a, const int8_t* b, size_t length) {
  int32_t sum = 0;
  for (size_t i = 0; i < length; ++i) sum += int32_t{a[i]} * b[i];
  return sum;
}

#else

using SumTag = hn::ScalableTag<int32_t>;
using NumberTag = hn::Repartition<int16_t, SumTag>;
using ByteTag = hn::Rebind<int8_t, NumberTag>;

// Products of 8-bit numbers fit 16 bits, and their sums in pairs 32.
HWY_INLINE int32_t Product(const int8_t* HWY_RESTRICT a, const int8_t* HWY_RESTRICT b,
                           size_t length) {
  const SumTag d;
  const NumberTag d16;
  const ByteTag d8;
  const size_t lanes = hn::Lanes(d16);
  auto even = hn::Zero(d);
  auto odd = hn::Zero(d);
  size_t i = 0;
  for (; i + lanes <= length; i += lanes)
    even = hn::ReorderWidenMulAccumulate(d, hn::PromoteTo(d16, hn::LoadU(d8, a + i)),
                                         hn::PromoteTo(d16, hn::LoadU(d8, b + i)), even, odd);
  int32_t sum = hn::GetLane(hn::SumOfLanes(d, hn::Add(even, odd)));
  for (; i < length; ++i) sum += int32_t{a[i]} * b[i];
  return sum;
}

#endif

// A row stays in the nearest cache while the query frames pass.
void Tile(std::span<const int8_t* const> queries, const int8_t* rows, size_t row_count,
          size_t length, int32_t* out) {
  for (size_t i = 0; i < row_count; ++i)
    for (size_t t = 0; t < queries.size(); ++t)
      out[t * row_count + i] = Product(queries[t], rows + i * length, length);
}

}  // namespace

CosineKernels Cosines() { return {Tile}; }

}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(Cosines);

CosineKernels select_cosine_kernels() { return HWY_DYNAMIC_DISPATCH(Cosines)(); }

}  // namespace vpr

#endif  // HWY_ONCE
