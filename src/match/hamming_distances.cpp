// Hamming distances. Compiled once per SIMD target: see Highway's foreach_target.h.
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <memory>
#include <mutex>
#include <numeric>

#include "base/error.h"
#include "match/frame_distances.h"
#include "match/huge_pages.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/hamming_distances.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#ifndef VPR_HAMMING_DISTANCES_ONCE
#define VPR_HAMMING_DISTANCES_ONCE
namespace vpr {
namespace {

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

}  // namespace
}  // namespace vpr
#endif

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

HammingKernels LdbKernels() { return {EncodeParities, LdbTile}; }
HammingKernels AnyKernels() { return {CopyWords, AnyTile}; }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(LdbKernels);
HWY_EXPORT(AnyKernels);

namespace {

constexpr size_t kWordBytes = sizeof(uint64_t);

/// The number of frames that have each bit set.
struct BitCounts {
  int64_t frames = 0;
  std::vector<uint32_t> ones;  ///< by bit of a row, with padding
  int64_t total = 0;           ///< their sum
};

// spread[b]: eight bytes, byte k is bit k of b. Adding them counts eight bits at once.
constexpr std::array<uint64_t, 256> spread_table() {
  std::array<uint64_t, 256> table{};
  for (size_t byte = 0; byte < table.size(); ++byte)
    for (size_t bit = 0; bit < 8; ++bit)
      if ((byte >> bit & 1) != 0) table[byte] |= uint64_t{1} << 8 * bit;
  return table;
}

constexpr std::array<uint64_t, 256> kSpread = spread_table();
constexpr size_t kMostInByte = 255;

// Counts the readable frames of all sequences, whose rows have `row_bytes` bytes. Fewer than 2^32
// frames.
BitCounts count_bits(std::span<const DescribedFrames> sequences, size_t row_bytes) {
  BitCounts counts{0, std::vector<uint32_t>(8 * row_bytes, 0), 0};
  std::vector<uint64_t> packed(row_bytes);
  for (const FrameStretch& run : readable_runs(sequences)) {
    const DescriptorRows& rows = sequences[run.sequence].rows;
    for (size_t first = 0; first < run.count; first += kMostInByte) {
      const size_t last = std::min(first + kMostInByte, run.count);
      std::fill(packed.begin(), packed.end(), 0);
      for (size_t i = first; i < last; ++i)
        for (size_t byte = 0; byte < row_bytes; ++byte)
          packed[byte] += kSpread[rows[run.first_in_sequence + i][byte]];
      for (size_t bit = 0; bit < counts.ones.size(); ++bit)
        counts.ones[bit] += static_cast<uint32_t>(packed[bit / 8] >> 8 * (bit % 8) & 0xff);
    }
    counts.frames += static_cast<int64_t>(run.count);
  }
  counts.total = std::accumulate(counts.ones.begin(), counts.ones.end(), int64_t{0});
  return counts;
}

uint64_t word_at(DescriptorRow code, size_t byte) {
  uint64_t word = 0;
  std::memcpy(&word, code.data() + byte, kWordBytes);
  return word;
}

template <class Body>
void for_each_set_bit(DescriptorRow code, const Body& body) {
  for (size_t byte = 0; byte < code.size(); byte += kWordBytes)
    for (uint64_t bits = word_at(code, byte); bits != 0; bits &= bits - 1)
      body(8 * byte + static_cast<size_t>(std::countr_zero(bits)));
}

// The sum of the distances of a code to the counted frames.
uint64_t distance_sum(const BitCounts& counts, DescriptorRow code) {
  // A clear bit differs from the codes in which it is set, a set bit from all others.
  int64_t sum = counts.total;
  for_each_set_bit(code, [&](size_t bit) { sum += counts.frames - 2 * int64_t{counts.ones[bit]}; });
  return static_cast<uint64_t>(sum);
}

/// Training frames in the format of the kernels: blocks of kBlockFrames, padded with zero codes.
struct Training {
  std::vector<DescribedFrames> sequences;
  size_t words = 0;  ///< per code
  HammingKernels kernels;
  std::vector<LaneWords, HugePageAllocator<LaneWords>> lanes;
  std::once_flag has_counts;
  BitCounts counts;  ///< over all readable frames; computed on first use
};

// Converts the few query codes again for each tile, which takes less time than a tile, and no
// memory for the codes of all queries.
void fill_tile(const Training& training, const DescriptorRows& rows,
               std::span<const uint32_t> queries, size_t first, size_t last, uint16_t* out,
               size_t stride) {
  assert(first % kBlockFrames == 0 && !queries.empty());
  const size_t words = training.words;
  std::vector<uint64_t> codes(queries.size() * words);
  for (size_t t = 0; t < queries.size(); ++t)
    training.kernels.encode(rows[queries[t]].data(), words, codes.data() + t * words);
  training.kernels.tile(codes.data(), queries.size(), words,
                        training.lanes.data() + first / kBlockFrames * words,
                        divide_up(last - first, kBlockFrames), out, stride);
}

PreparedTraining prepare(std::span<const DescribedFrames> train, const DescriptorShape& shape) {
  const size_t words = shape.row_bytes() / kWordBytes;
  if (words > kMaxBits / 64)
    throw Error(ErrorKind::data, "codes of {} bits: the maximum for Hamming distances is {}",
                shape.length, kMaxBits);
  const auto training = std::make_shared<Training>();
  training->sequences.assign(train.begin(), train.end());
  training->words = words;
  training->kernels = words == kLdbBytes / kWordBytes ? HWY_DYNAMIC_DISPATCH(LdbKernels)()
                                                      : HWY_DYNAMIC_DISPATCH(AnyKernels)();
  training->lanes.resize(divide_up(count_frames(train), kBlockFrames) * words);
  std::vector<uint64_t> code(words);
  size_t frame = 0;
  for (const DescribedFrames& sequence : train)
    for (size_t i = 0; i < sequence.rows.size(); ++i, ++frame) {
      training->kernels.encode(sequence.rows[i].data(), words, code.data());
      LaneWords* block = training->lanes.data() + frame / kBlockFrames * words;
      for (size_t w = 0; w < words; ++w) block[w].frames[frame % kBlockFrames] = code[w];
    }
  return [training](FrameDistances& distances) {
    const DescriptorRows rows = distances.query.rows;
    distances.tile = [training, rows](std::span<const uint32_t> queries, size_t first, size_t last,
                                      uint16_t* out, size_t stride) {
      fill_tile(*training, rows, queries, first, last, out, stride);
    };
    distances.row_total = [training, rows](size_t query) {
      std::call_once(training->has_counts, [&] {
        training->counts = count_bits(training->sequences, training->words * kWordBytes);
      });
      return distance_sum(training->counts, rows[query]);
    };
  };
}

// A clear bit differs from the descriptors in which it is set, a set bit from the others.
Projector make_projector(const DescriptorRows& to, std::span<const ComponentValues> weights) {
  struct Sums {
    ComponentValues of_none = {};              ///< of a descriptor without a set bit
    std::vector<ComponentValues> more_of_bit;  ///< the contribution of each bit
  };
  const auto sums = std::make_shared<Sums>();
  sums->more_of_bit.resize(8 * to.shape.row_bytes());
  for (size_t i = 0; i < to.size(); ++i)
    for (size_t bit = 0; bit < sums->more_of_bit.size(); ++bit) {
      const bool is_set = (to[i][bit / 8] >> bit % 8 & 1) != 0;
      for (size_t k = 0; k < kMaxComponents; ++k) {
        sums->more_of_bit[bit][k] += is_set ? -weights[i][k] : weights[i][k];
        if (is_set) sums->of_none[k] += weights[i][k];
      }
    }
  return [sums](DescriptorRow row) {
    ComponentValues values = sums->of_none;
    for_each_set_bit(row, [&](size_t bit) {
      for (size_t k = 0; k < kMaxComponents; ++k) values[k] += sums->more_of_bit[bit][k];
    });
    return ComponentValues(values);  // a copy, so that the sums stay in registers
  };
}

}  // namespace

uint32_t hamming_distance(DescriptorRow a, DescriptorRow b) {
  int distance = 0;
  for (size_t byte = 0; byte < a.size(); byte += kWordBytes)
    distance += std::popcount(word_at(a, byte) ^ word_at(b, byte));
  return static_cast<uint32_t>(distance);
}

const DistanceKind kHammingDistance = {
    ElementType::bits,
    {"bits", 1},
    [](const DescriptorShape& shape) { return uint16_t(shape.length); },
    hamming_distance,
    make_projector,
    prepare};

}  // namespace vpr

#endif  // HWY_ONCE
