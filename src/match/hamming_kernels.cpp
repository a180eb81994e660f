// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "match/hamming_kernels.h"

#include <cstring>

#include "describe/descriptor_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/hamming_kernels.cpp"
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

constexpr size_t kLdbWords = kLdbBytes / 8;
constexpr size_t kLanes = hn::MaxLanes(WordTag());  // frames per vector: 8, 4, 2 or 1
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

#if HWY_TARGET == HWY_SCALAR  // one lane, without bytes

HWY_INLINE Words CountBits(Words v) { return hn::PopulationCount(v); }
HWY_INLINE Words SumBytes(Words v) { return v; }
HWY_INLINE Words AddCounts(Words a, Words b) { return hn::Add(a, b); }

#else  // counts bits in bytes: a sum of at most 176 fits one byte

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
// parities is the prefix parity of the differing bits, so a full adder over two more words costs
// one operation (Carry), and 12 population counts do the work of 22.
HWY_INLINE Words Distances(const Words* HWY_RESTRICT frames, const uint64_t* HWY_RESTRICT query) {
  const WordTag d;
  Words parity = hn::Zero(d);
  Words carries = hn::Zero(d);
  HWY_UNROLL(kLdbWords / 2)
  for (size_t w = 0; w < kLdbWords; w += 2) {
    const Words middle = hn::Xor(frames[w], hn::Set(d, query[w]));
    const Words last = hn::Xor(frames[w + 1], hn::Set(d, query[w + 1]));
    carries = AddCounts(carries, CountBits(Carry(parity, middle, last)));
    parity = last;
  }
  return SumBytes(AddCounts(AddCounts(carries, carries), CountBits(parity)));
}

// Part p of a block: frames p * kLanes and on, of every word.
HWY_INLINE void LoadFrames(const LaneWords* HWY_RESTRICT block, size_t part,
                           Words* HWY_RESTRICT frames) {
  const WordTag d;
  HWY_UNROLL(kLdbWords)
  for (size_t w = 0; w < kLdbWords; ++w)
    frames[w] = hn::LoadU(d, block[w].frames.data() + part * kLanes);
}

HWY_INLINE void StoreDistances(Words distances, uint16_t* HWY_RESTRICT out) {
  const DistanceTag d16;
  hn::StoreU(hn::TruncateTo(d16, distances), d16, out);
}

// Word w becomes the prefix parity code[0] ^ ... ^ code[w].
void EncodeParities(const uint8_t* code, size_t, uint64_t* words) {
  std::memcpy(words, code, kLdbBytes);
  for (size_t w = 1; w < kLdbWords; ++w) words[w] ^= words[w - 1];
}

// One query frame, with fewer than 22 live vectors: each word is used when it is loaded.
void LdbRow(const uint64_t* query, const LaneWords* blocks, size_t block_count, uint16_t* out) {
  for (size_t b = 0; b < block_count; ++b) {
    for (size_t part = 0; part < kBlockFrames / kLanes; ++part) {
      Words frames[kLdbWords];
      LoadFrames(blocks + b * kLdbWords, part, frames);
      StoreDistances(Distances(frames, query), out + b * kBlockFrames + part * kLanes);
    }
  }
}

// The block stays in registers for all query frames.
void LdbTile(const uint64_t* queries, size_t query_count, size_t, const LaneWords* blocks,
             size_t block_count, uint16_t* out, size_t out_stride) {
  if (query_count == 1) return LdbRow(queries, blocks, block_count, out);
  for (size_t b = 0; b < block_count; ++b) {
    for (size_t part = 0; part < kBlockFrames / kLanes; ++part) {
      Words frames[kLdbWords];
      LoadFrames(blocks + b * kLdbWords, part, frames);
      uint16_t* HWY_RESTRICT to = out + b * kBlockFrames + part * kLanes;
      for (size_t t = 0; t < query_count; ++t)
        StoreDistances(Distances(frames, queries + t * kLdbWords), to + t * out_stride);
    }
  }
}

void CopyWords(const uint8_t* code, size_t words, uint64_t* out) {
  std::memcpy(out, code, words * sizeof(uint64_t));
}

void AnyTile(const uint64_t* queries, size_t query_count, size_t words, const LaneWords* blocks,
             size_t block_count, uint16_t* out, size_t out_stride) {
  const WordTag d;
  for (size_t b = 0; b < block_count; ++b) {
    const LaneWords* block = blocks + b * words;
    for (size_t part = 0; part < kBlockFrames / kLanes; ++part) {
      uint16_t* HWY_RESTRICT to = out + b * kBlockFrames + part * kLanes;
      for (size_t t = 0; t < query_count; ++t) {
        const uint64_t* query = queries + t * words;
        Words sum = hn::Zero(d);
        for (size_t w = 0; w < words; ++w) {
          const Words frames = hn::LoadU(d, block[w].frames.data() + part * kLanes);
          sum = hn::Add(sum, hn::PopulationCount(hn::Xor(frames, hn::Set(d, query[w]))));
        }
        StoreDistances(sum, to + t * out_stride);
      }
    }
  }
}

}  // namespace

HammingKernels LdbKernels() { return {EncodeParities, LdbTile}; }
HammingKernels AnyKernels() { return {CopyWords, AnyTile}; }

}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(LdbKernels);
HWY_EXPORT(AnyKernels);

HammingKernels select_hamming_kernels(size_t words) {
  return words == kLdbBytes / 8 ? HWY_DYNAMIC_DISPATCH(LdbKernels)()
                                : HWY_DYNAMIC_DISPATCH(AnyKernels)();
}

}  // namespace vpr

#endif  // HWY_ONCE
