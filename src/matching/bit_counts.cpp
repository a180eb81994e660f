#include "matching/bit_counts.h"

#include <array>
#include <bit>
#include <cstring>
#include <numeric>

#include "matching/frame_runs.h"

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
  explicit BitCounter(size_t row_bytes)
      : counts_{0, std::vector<uint32_t>(8 * row_bytes, 0), 0}, packed_(row_bytes, 0) {}

  void add(DescriptorRow code) {
    for (size_t i = 0; i < packed_.size(); ++i) packed_[i] += kSpread[code[i]];
    ++counts_.frames;
    if (++pending_ == kMostInByte) flush();
  }
  BitCounts result() {
    flush();
    counts_.total = std::accumulate(counts_.ones.begin(), counts_.ones.end(), int64_t{0});
    return std::move(counts_);
  }

 private:
  void flush() {
    for (size_t i = 0; i < packed_.size(); ++i) {
      for (size_t bit = 0; bit < 8; ++bit)
        counts_.ones[8 * i + bit] += static_cast<uint32_t>(packed_[i] >> 8 * bit & 0xff);
      packed_[i] = 0;
    }
    pending_ = 0;
  }

  BitCounts counts_;
  std::vector<uint64_t> packed_;
  size_t pending_ = 0;
};

}  // namespace

BitCounts count_bits(std::span<const DescriptorSpan> sequences, size_t row_bytes) {
  BitCounter counter(row_bytes);
  for (const DescriptorSpan& sequence : sequences)
    for (const FrameRun& run : readable_runs(sequence))
      for (size_t i = 0; i < run.count; ++i) counter.add(sequence.rows[run.first + i]);
  return counter.result();
}

uint64_t distance_sum(const BitCounts& counts, DescriptorRow code) {
  // A bit that is not set differs from the codes that have it, one that is set from all others.
  int64_t sum = counts.total;
  const auto frames = static_cast<int64_t>(counts.frames);
  for (size_t byte = 0; byte < code.size(); byte += sizeof(uint64_t)) {
    uint64_t bits = 0;
    std::memcpy(&bits, code.data() + byte, sizeof(bits));
    for (; bits != 0; bits &= bits - 1)
      sum +=
          frames - 2 * int64_t{counts.ones[8 * byte + static_cast<size_t>(std::countr_zero(bits))]};
  }
  return static_cast<uint64_t>(sum);
}

}  // namespace vpr
