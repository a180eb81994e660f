#include "matching/bit_counts.h"

#include <bit>
#include <numeric>

namespace vpr {
namespace {

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

class BitCounter {
 public:
  void add(const LdbCode& code) {
    for (size_t i = 0; i < kLdbBytes; ++i) packed_[i] += kSpread[code[i]];
    ++counts_.frames;
    if (++pending_ == kMostInByte) flush();
  }
  BitCounts result() {
    flush();
    return counts_;
  }

 private:
  void flush() {
    for (size_t i = 0; i < kLdbBytes; ++i)
      for (size_t bit = 0; bit < 8; ++bit)
        counts_.ones[8 * i + bit] += static_cast<uint32_t>(packed_[i] >> 8 * bit & 0xff);
    packed_.fill(0);
    pending_ = 0;
  }

  BitCounts counts_;
  std::array<uint64_t, kLdbBytes> packed_ = {};
  size_t pending_ = 0;
};

// Bits in which a frame of `a` and one of `b` differ, summed over all pairs: below 2^64 for sets of
// less than 100 million frames.
uint64_t differing_pairs(const BitCounts& a, const BitCounts& b) {
  uint64_t sum = 0;
  for (size_t bit = 0; bit < a.ones.size(); ++bit)
    sum += a.ones[bit] * uint64_t{b.frames - b.ones[bit]} +
           (a.frames - a.ones[bit]) * uint64_t{b.ones[bit]};
  return sum;
}

// Bits in which the code differs from those that were counted, over all of them.
uint64_t distance_sum(const BitCounts& counts, const CodeWords& code) {
  // A bit that is not set differs from the codes that have it, one that is set from all others.
  int64_t sum = std::accumulate(counts.ones.begin(), counts.ones.end(), int64_t{0});
  const auto frames = static_cast<int64_t>(counts.frames);
  uint64_t before = 0;
  for (size_t w = 0; w < kCodeWords; ++w) {
    const uint64_t parity = code[w];  // codes are kept as prefix parities
    for (uint64_t bits = parity ^ before; bits != 0; bits &= bits - 1)
      sum += frames - 2 * int64_t{counts.ones[64 * w + std::countr_zero(bits)]};
    before = parity;
  }
  return static_cast<uint64_t>(sum);
}

}  // namespace

BitCounts count_bits(std::span<const CodeSpan> sequences) {
  BitCounter counter;
  for (const CodeSpan& sequence : sequences)
    for (const FrameRun& run : readable_runs(sequence))
      for (const LdbCode& code : sequence.codes.subspan(run.first, run.count)) counter.add(code);
  return counter.result();
}

BitCounts without(const BitCounts& all, const BitCounts& some) {
  BitCounts rest = all;
  rest.frames -= some.frames;
  for (size_t bit = 0; bit < rest.ones.size(); ++bit) rest.ones[bit] -= some.ones[bit];
  return rest;
}

double mean_distance(const BitCounts& counts, const CodeWords& code) {
  if (counts.frames == 0) return 0;
  return static_cast<double>(distance_sum(counts, code)) / static_cast<double>(counts.frames);
}

std::vector<double> mean_window_distances(const BitCounts& counts, std::span<const LdbCode> query,
                                          size_t window_length) {
  if (query.size() < window_length) return {};
  std::vector<double> means(query.size() - window_length + 1, 0);
  if (counts.frames == 0) return means;
  std::vector<uint64_t> sums;
  sums.reserve(query.size());
  for (const LdbCode& code : query) sums.push_back(distance_sum(counts, code_words(code)));
  uint64_t sum = std::accumulate(
      sums.begin(), sums.begin() + static_cast<ptrdiff_t>(window_length - 1), uint64_t{0});
  for (size_t window = 0; window < means.size(); ++window) {
    sum += sums[window + window_length - 1];
    means[window] = static_cast<double>(sum) / static_cast<double>(counts.frames);
    sum -= sums[window];
  }
  return means;
}

double mean_distance_between(const BitCounts& a, const BitCounts& b) {
  if (a.frames == 0 || b.frames == 0) return 0;
  const auto pairs = static_cast<double>(a.frames) * static_cast<double>(b.frames);
  return static_cast<double>(differing_pairs(a, b)) / pairs;
}

double mean_distance_within(const BitCounts& counts) {
  if (counts.frames < 2) return 0;
  const auto pairs = static_cast<double>(counts.frames) * static_cast<double>(counts.frames - 1);
  return static_cast<double>(differing_pairs(counts, counts)) / pairs;
}

}  // namespace vpr
