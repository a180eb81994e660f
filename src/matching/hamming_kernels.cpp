// Compiled several times, once for each SIMD target: see Highway's foreach_target.h.
#include "base/highway.h"
// The settings above come first.
#include "matching/hamming_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/hamming_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using WordTag = hn::CappedTag<uint64_t, kBlockFrames>;
using Words = hn::Vec<WordTag>;
using DistanceTag = hn::Rebind<uint16_t, WordTag>;
using SumTag = hn::ScalableTag<uint32_t>;
using HalfTag = hn::Rebind<uint16_t, SumTag>;

constexpr size_t kLanes = hn::MaxLanes(WordTag());  // frames a vector: 8, 4, 2 or 1
static_assert(kBlockFrames % kLanes == 0);

// The sums of bits of three words a, b, c are carry bits of weight 2 and parity bits of weight 1.
// With the parities p = a, q = a ^ b, r = a ^ b ^ c, carry = (q ? ~r : p).
HWY_INLINE Words Carry(Words p, Words q, Words r) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
  return Words{_mm512_ternarylogic_epi64(q.raw, r.raw, p.raw, 0x3A)};
#else
  return hn::Or(hn::AndNot(r, q), hn::AndNot(q, p));
#endif
}

#if HWY_TARGET == HWY_SCALAR  // one lane, which has no bytes

HWY_INLINE Words CountBits(Words v) { return hn::PopulationCount(v); }
HWY_INLINE Words SumBytes(Words v) { return v; }
HWY_INLINE Words AddCounts(Words a, Words b) { return hn::Add(a, b); }

#else  // bits are counted in bytes: a sum of 176 at most fits in one

using ByteTag = hn::Repartition<uint8_t, WordTag>;

HWY_INLINE Words CountBits(Words v) {
  return hn::BitCast(WordTag(), hn::PopulationCount(hn::BitCast(ByteTag(), v)));
}
HWY_INLINE Words SumBytes(Words v) { return hn::SumsOf8(hn::BitCast(ByteTag(), v)); }
HWY_INLINE Words AddCounts(Words a, Words b) {
  return hn::BitCast(WordTag(), hn::Add(hn::BitCast(ByteTag(), a), hn::BitCast(ByteTag(), b)));
}

#endif

// Distances of `kLanes` frames, from prefix parities. The exclusive or of two codes' prefix
// parities is the prefix parity of the differing bits, so that a full adder over two more words
// costs one operation (Carry), and 12 population counts do the work of 22.
HWY_INLINE Words Distances(const Words* HWY_RESTRICT frames, const uint64_t* HWY_RESTRICT query) {
  const WordTag d;
  Words parity = hn::Zero(d);
  Words carries = hn::Zero(d);
  HWY_UNROLL(kCodeWords / 2)
  for (size_t w = 0; w < kCodeWords; w += 2) {
    const Words middle = hn::Xor(frames[w], hn::Set(d, query[w]));
    const Words last = hn::Xor(frames[w + 1], hn::Set(d, query[w + 1]));
    carries = AddCounts(carries, CountBits(Carry(parity, middle, last)));
    parity = last;
  }
  return SumBytes(AddCounts(AddCounts(carries, carries), CountBits(parity)));
}

// Part p of a block: frames p * kLanes and on, of every word.
HWY_INLINE void LoadFrames(const CodeBlock& block, size_t part, Words* HWY_RESTRICT frames) {
  const WordTag d;
  HWY_UNROLL(kCodeWords)
  for (size_t w = 0; w < kCodeWords; ++w)
    frames[w] = hn::LoadU(d, block.words[w].data() + part * kLanes);
}

HWY_INLINE void StoreDistances(Words distances, uint16_t* HWY_RESTRICT out) {
  const DistanceTag d16;
  hn::StoreU(hn::TruncateTo(d16, distances), d16, out);
}

// One query frame, fewer than 22 vectors live: each word is used as it is loaded.
void RowDistances(const CodeWords& query, const CodeBlock* blocks, size_t block_count,
                  uint16_t* out) {
  for (size_t b = 0; b < block_count; ++b) {
    for (size_t part = 0; part < kBlockFrames / kLanes; ++part) {
      Words frames[kCodeWords];
      LoadFrames(blocks[b], part, frames);
      StoreDistances(Distances(frames, query.data()), out + b * kBlockFrames + part * kLanes);
    }
  }
}

// The block stays in registers while the query frames pass.
void TileDistances(const CodeWords* queries, size_t query_count, const CodeBlock* blocks,
                   size_t block_count, uint16_t* out, size_t out_stride) {
  for (size_t b = 0; b < block_count; ++b) {
    for (size_t part = 0; part < kBlockFrames / kLanes; ++part) {
      Words frames[kCodeWords];
      LoadFrames(blocks[b], part, frames);
      uint16_t* HWY_RESTRICT to = out + b * kBlockFrames + part * kLanes;
      for (size_t t = 0; t < query_count; ++t)
        StoreDistances(Distances(frames, queries[t].data()), to + t * out_stride);
    }
  }
}

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

}  // namespace

HammingKernels Kernels() {
  return {hwy::TargetName(HWY_TARGET),
          RowDistances,
          TileDistances,
          Slide,
          Accumulate,
          Minimum,
          Maximum,
          FindBelow};
}

}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(Kernels);

HammingKernels select_kernels() { return HWY_DYNAMIC_DISPATCH(Kernels)(); }

}  // namespace vpr

#endif  // HWY_ONCE
