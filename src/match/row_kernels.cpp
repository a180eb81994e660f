// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "match/row_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/row_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using SumTag = hn::ScalableTag<uint32_t>;
using HalfTag = hn::Rebind<uint16_t, SumTag>;

void Slide(const uint32_t* before, const uint16_t* entering, const uint16_t* leaving,
           uint32_t* after, size_t count) {
  const SumTag d;
  const HalfTag d16;
  const size_t lanes = hn::Lanes(d);
  size_t x = 0;
  for (; x + lanes <= count; x += lanes) {
    const auto in = hn::PromoteTo(d, hn::LoadU(d16, entering + x));
    const auto out = hn::PromoteTo(d, hn::LoadU(d16, leaving + x));
    hn::StoreU(hn::Sub(hn::Add(hn::LoadU(d, before + x), in), out), d, after + x);
  }
  for (; x < count; ++x) after[x] = before[x] + entering[x] - leaving[x];
}

void Accumulate(uint32_t* sums, const uint16_t* entering, size_t count) {
  const SumTag d;
  const HalfTag d16;
  const size_t lanes = hn::Lanes(d);
  size_t x = 0;
  for (; x + lanes <= count; x += lanes)
    hn::StoreU(hn::Add(hn::LoadU(d, sums + x), hn::PromoteTo(d, hn::LoadU(d16, entering + x))), d,
               sums + x);
  for (; x < count; ++x) sums[x] += entering[x];
}

uint32_t Minimum(const uint32_t* values, size_t count) {
  const SumTag d;
  const size_t lanes = hn::Lanes(d);
  uint32_t least = values[0];
  size_t x = 0;
  if (count >= lanes) {
    auto all = hn::LoadU(d, values);
    for (x = lanes; x + lanes <= count; x += lanes) all = hn::Min(all, hn::LoadU(d, values + x));
    least = hn::GetLane(hn::MinOfLanes(d, all));
  }
  for (; x < count; ++x) least = values[x] < least ? values[x] : least;
  return least;
}

uint32_t Maximum(const uint32_t* values, size_t count) {
  const SumTag d;
  const size_t lanes = hn::Lanes(d);
  uint32_t most = values[0];
  size_t x = 0;
  if (count >= lanes) {
    auto all = hn::LoadU(d, values);
    for (x = lanes; x + lanes <= count; x += lanes) all = hn::Max(all, hn::LoadU(d, values + x));
    most = hn::GetLane(hn::MaxOfLanes(d, all));
  }
  for (; x < count; ++x) most = values[x] > most ? values[x] : most;
  return most;
}

size_t FindBelow(const uint32_t* values, size_t begin, size_t count, uint32_t limit) {
  const SumTag d;
  const size_t lanes = hn::Lanes(d);
  const auto bound = hn::Set(d, limit);
  size_t x = begin;
  for (; x + lanes <= count; x += lanes) {
    const auto below = hn::Lt(hn::LoadU(d, values + x), bound);
    const intptr_t first = hn::FindFirstTrue(d, below);
    if (first >= 0) return x + static_cast<size_t>(first);
  }
  while (x < count && values[x] >= limit) ++x;
  return x;
}

}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(Slide);
HWY_EXPORT(Accumulate);
HWY_EXPORT(Minimum);
HWY_EXPORT(Maximum);
HWY_EXPORT(FindBelow);

void slide_sums(const uint32_t* before, const uint16_t* entering, const uint16_t* leaving,
                uint32_t* after, size_t count) {
  HWY_DYNAMIC_DISPATCH(Slide)(before, entering, leaving, after, count);
}

void add_to_sums(std::span<uint32_t> sums, const uint16_t* entering) {
  HWY_DYNAMIC_DISPATCH(Accumulate)(sums.data(), entering, sums.size());
}

uint32_t minimum_of(std::span<const uint32_t> values) {
  return HWY_DYNAMIC_DISPATCH(Minimum)(values.data(), values.size());
}

uint32_t maximum_of(std::span<const uint32_t> values) {
  return HWY_DYNAMIC_DISPATCH(Maximum)(values.data(), values.size());
}

size_t find_below(std::span<const uint32_t> values, size_t begin, uint32_t limit) {
  return HWY_DYNAMIC_DISPATCH(FindBelow)(values.data(), begin, values.size(), limit);
}

}  // namespace vpr

#endif  // HWY_ONCE
