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
#include "match/hamming_kernels.h"

namespace vpr {
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
  std::vector<LaneWords> lanes;
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
  training->kernels = select_hamming_kernels(words);
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
