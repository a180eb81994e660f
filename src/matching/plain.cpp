#include "matching/plain.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "matching/frame_distances.h"

namespace vpr {
namespace {

constexpr std::array<uint8_t, 256> bit_counts() {
  std::array<uint8_t, 256> counts{};
  for (size_t value = 0; value < counts.size(); ++value)
    counts[value] = static_cast<uint8_t>(counts[value / 2] + value % 2);
  return counts;
}

constexpr std::array<uint8_t, 256> kBitCounts = bit_counts();

// A byte as the number that it is in two's complement.
int64_t signed_value(uint8_t byte) { return byte < 128 ? byte : byte - 256; }

}  // namespace

uint32_t plain_hamming(DescriptorRow a, DescriptorRow b) {
  uint32_t distance = 0;
  for (size_t i = 0; i < a.size(); ++i) distance += kBitCounts[a[i] ^ b[i]];
  return distance;
}

double plain_hamming_unrounded(DescriptorRow a, DescriptorRow b) { return plain_hamming(a, b); }

double plain_cosine_unrounded(DescriptorRow a, DescriptorRow b) {
  int64_t product = 0;
  int64_t square_a = 0;
  int64_t square_b = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const int64_t x = signed_value(a[i]);
    const int64_t y = signed_value(b[i]);
    product += x * y;
    square_a += x * x;
    square_b += y * y;
  }
  const double lengths =
      std::sqrt(static_cast<double>(square_a)) * std::sqrt(static_cast<double>(square_b));
  const double cosine = lengths > 0 ? static_cast<double>(product) / lengths : 0;
  return (1 - cosine) * 65535 / 2;
}

uint32_t plain_cosine(DescriptorRow a, DescriptorRow b) {
  return static_cast<uint32_t>(std::clamp(plain_cosine_unrounded(a, b) + 0.5, 0.0, 65535.0));
}

uint32_t plain_distance(const DescriptorRows& a, size_t frame_a, const DescriptorRows& b,
                        size_t frame_b) {
  assert(a.shape == b.shape);
  return distance_of(a.shape.element).plain(a[frame_a], b[frame_b]);
}

uint32_t plain_window_distance(const DescriptorRows& train, size_t train_window,
                               const DescriptorRows& query, size_t query_window,
                               size_t window_length) {
  assert(train_window + window_length <= train.size());
  assert(query_window + window_length <= query.size());
  uint32_t sum = 0;
  for (size_t k = 0; k < window_length; ++k)
    sum += plain_distance(train, train_window + k, query, query_window + k);
  return sum;
}

}  // namespace vpr
