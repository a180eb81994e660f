#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <memory>
#include <mutex>
#include <numeric>

#include <fmt/format.h>

#include "base/error.h"
#include "match/frame_distances.h"
#include "match/frame_runs.h"
#include "match/hamming_kernels.h"

namespace vpr {

namespace {

constexpr size_t kWordBytes = sizeof(uint64_t);
constexpr size_t kFewWords = 2 * kLdbBytes / kWordBytes;  // two LDB codes need no allocation
constexpr size_t kMostWords = kMaxBits / 64;

/// The number of frames that have each bit set.
struct BitCounts {
  size_t frames = 0;
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

// Counts the readable frames of all sequences, whose rows have `row_bytes` bytes. Fewer than 2^32
// frames.
BitCounts count_bits(std::span<const DescriptorSpan> sequences, size_t row_bytes) {
  BitCounter counter(row_bytes);
  for (const DescriptorSpan& sequence : sequences)
    for (const FrameRun& run : readable_runs(sequence))
      for (size_t i = 0; i < run.count; ++i) counter.add(sequence.rows[run.first + i]);
  return counter.result();
}

// The sum of the distances of a code to the counted frames.
uint64_t distance_sum(const BitCounts& counts, DescriptorRow code) {
  // A clear bit differs from the codes in which it is set, a set bit from all others.
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

/// The common data of distances to the same training frames. `lanes` are these frames in the layout
/// of the kernels, `words` per block, padded with zero codes to whole blocks.
struct Training {
  std::vector<DescriptorSpan> sequences;
  size_t words = 0;
  HammingKernels kernels;
  std::vector<LaneWords> lanes;
  std::once_flag has_counts;
  BitCounts counts;  ///< over all readable frames; computed on first use
};

std::vector<LaneWords> make_lanes(const Training& training) {
  const size_t words = training.words;
  const size_t frames = count_frames(training.sequences);
  std::vector<LaneWords> lanes((frames + kStretchFrames - 1) / kStretchFrames * words);
  std::vector<uint64_t> code(words);
  size_t frame = 0;
  for (const DescriptorSpan& sequence : training.sequences) {
    for (size_t i = 0; i < sequence.rows.size(); ++i, ++frame) {
      training.kernels.encode(sequence.rows[i].data(), words, code.data());
      LaneWords* block = lanes.data() + frame / kStretchFrames * words;
      for (size_t w = 0; w < words; ++w) block[w].frames[frame % kStretchFrames] = code[w];
    }
  }
  return lanes;
}

std::vector<uint64_t> encode(const Training& training, const DescriptorRows& rows) {
  std::vector<uint64_t> codes(rows.size() * training.words);
  for (size_t i = 0; i < rows.size(); ++i)
    training.kernels.encode(rows[i].data(), training.words, codes.data() + i * training.words);
  return codes;
}

bool are_adjacent(std::span<const uint32_t> queries) {
  for (size_t t = 1; t < queries.size(); ++t)
    if (queries[t] != queries[0] + t) return false;
  return true;
}

void fill_tile(const Training& training, const std::vector<uint64_t>& codes,
               std::span<const uint32_t> queries, size_t first, size_t last, uint16_t* out,
               size_t stride) {
  assert(first % kStretchFrames == 0 && !queries.empty());
  const size_t words = training.words;
  const uint64_t* from = codes.data() + queries[0] * words;
  std::array<uint64_t, kFewWords> few;
  std::vector<uint64_t> many;
  if (!are_adjacent(queries)) {
    if (queries.size() * words > few.size()) many.resize(queries.size() * words);
    uint64_t* gathered = many.empty() ? few.data() : many.data();
    for (size_t t = 0; t < queries.size(); ++t)
      std::copy_n(codes.data() + queries[t] * words, words, gathered + t * words);
    from = gathered;
  }
  training.kernels.tile(from, queries.size(), words,
                        training.lanes.data() + first / kStretchFrames * words,
                        (last - first + kStretchFrames - 1) / kStretchFrames, out, stride);
}

FrameDistances distances_of(const std::shared_ptr<Training>& training,
                            const DescriptorSpan& query) {
  FrameDistances distances = frames_to_compare(training->sequences, query);
  const auto codes = std::make_shared<const std::vector<uint64_t>>(encode(*training, query.rows));
  distances.tile = [training, codes](std::span<const uint32_t> queries, size_t first, size_t last,
                                     uint16_t* out, size_t stride) {
    fill_tile(*training, *codes, queries, first, last, out, stride);
  };
  distances.row_total = [training, rows = query.rows](size_t frame) {
    std::call_once(training->has_counts, [&] {
      training->counts = count_bits(training->sequences, training->words * kWordBytes);
    });
    return distance_sum(training->counts, rows[frame]);
  };
  distances.of_query = [training](const DescriptorSpan& other) {
    return distances_of(training, other);
  };
  return distances;
}

}  // namespace

uint16_t largest_hamming(const DescriptorShape& shape) {
  return static_cast<uint16_t>(shape.length);
}

uint32_t hamming_distance(DescriptorRow a, DescriptorRow b) {
  int distance = 0;
  for (size_t byte = 0; byte < a.size(); byte += kWordBytes) {
    uint64_t left = 0;
    uint64_t right = 0;
    std::memcpy(&left, a.data() + byte, kWordBytes);
    std::memcpy(&right, b.data() + byte, kWordBytes);
    distance += std::popcount(left ^ right);
  }
  return static_cast<uint32_t>(distance);
}

// A clear bit differs from the descriptors in which it is set, a set bit from the others.
Projector hamming_projector(const DescriptorRows& to, std::span<const ComponentValues> weights) {
  struct Sums {
    ComponentValues of_none = {};              ///< of a descriptor without a set bit
    std::vector<ComponentValues> more_of_bit;  ///< the contribution of each bit
  };
  const auto sums = std::make_shared<Sums>();
  sums->more_of_bit.resize(8 * to.shape.row_bytes());
  for (size_t i = 0; i < to.size(); ++i) {
    const DescriptorRow row = to[i];
    for (size_t bit = 0; bit < sums->more_of_bit.size(); ++bit) {
      const bool is_set = (row[bit / 8] >> bit % 8 & 1) != 0;
      for (size_t k = 0; k < kMaxComponents; ++k) {
        sums->more_of_bit[bit][k] += is_set ? -weights[i][k] : weights[i][k];
        if (is_set) sums->of_none[k] += weights[i][k];
      }
    }
  }
  return [sums](DescriptorRow row) {
    ComponentValues values = sums->of_none;
    for (size_t byte = 0; byte < row.size(); byte += kWordBytes) {
      uint64_t bits = 0;
      std::memcpy(&bits, row.data() + byte, kWordBytes);
      for (; bits != 0; bits &= bits - 1) {
        const ComponentValues& more =
            sums->more_of_bit[8 * byte + static_cast<size_t>(std::countr_zero(bits))];
        for (size_t k = 0; k < kMaxComponents; ++k) values[k] += more[k];
      }
    }
    return values;
  };
}

FrameDistances hamming_distances(std::span<const DescriptorSpan> train,
                                 const DescriptorSpan& query) {
  const size_t row_bytes = query.rows.shape.row_bytes();
  if (row_bytes > kMostWords * kWordBytes)
    throw Error(ErrorKind::data,
                fmt::format("codes of {} bits: the maximum for Hamming distances is {}",
                            query.rows.shape.length, 8 * kMostWords * kWordBytes));
  const auto training = std::make_shared<Training>();
  training->sequences.assign(train.begin(), train.end());
  training->words = row_bytes / kWordBytes;
  training->kernels = select_hamming_kernels(training->words);
  training->lanes = make_lanes(*training);
  return distances_of(training, query);
}

}  // namespace vpr
