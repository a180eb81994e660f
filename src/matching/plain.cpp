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

// Bytes as the numbers that they are in two's complement.
std::vector<int64_t> signed_values(DescriptorRow row) {
  std::vector<int64_t> values;
  for (const uint8_t byte : row) values.push_back(byte < 128 ? byte : byte - 256);
  return values;
}

// The same of pairs of bytes, the lower first.
std::vector<int64_t> wide_values(DescriptorRow row) {
  std::vector<int64_t> values;
  for (size_t i = 0; i < row.size(); i += 2) {
    const int64_t value = row[i] + 256 * int64_t{row[i + 1]};
    values.push_back(value < 32768 ? value : value - 65536);
  }
  return values;
}

double cosine_of(const std::vector<int64_t>& a, const std::vector<int64_t>& b) {
  int64_t product = 0;
  int64_t square_a = 0;
  int64_t square_b = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    product += a[i] * b[i];
    square_a += a[i] * a[i];
    square_b += b[i] * b[i];
  }
  const double lengths =
      std::sqrt(static_cast<double>(square_a)) * std::sqrt(static_cast<double>(square_b));
  const double cosine = lengths > 0 ? static_cast<double>(product) / lengths : 0;
  return (1 - cosine) * 65535 / 2;
}

uint32_t rounded(double cosine) {
  return static_cast<uint32_t>(std::clamp(cosine + 0.5, 0.0, 65535.0));
}

}  // namespace

uint32_t plain_hamming(DescriptorRow a, DescriptorRow b) {
  uint32_t distance = 0;
  for (size_t i = 0; i < a.size(); ++i) distance += kBitCounts[a[i] ^ b[i]];
  return distance;
}

double plain_hamming_unrounded(DescriptorRow a, DescriptorRow b) { return plain_hamming(a, b); }

double plain_cosine_unrounded(DescriptorRow a, DescriptorRow b) {
  return cosine_of(signed_values(a), signed_values(b));
}

double plain_wide_cosine_unrounded(DescriptorRow a, DescriptorRow b) {
  return cosine_of(wide_values(a), wide_values(b));
}

uint32_t plain_cosine(DescriptorRow a, DescriptorRow b) {
  return rounded(plain_cosine_unrounded(a, b));
}

uint32_t plain_wide_cosine(DescriptorRow a, DescriptorRow b) {
  return rounded(plain_wide_cosine_unrounded(a, b));
}

double plain_point_unrounded(DescriptorRow a, DescriptorRow b) {
  const std::vector<int64_t> from = wide_values(a);
  const std::vector<int64_t> to = wide_values(b);
  double sum = 0;
  for (size_t i = 0; i < from.size(); ++i)
    sum += static_cast<double>((from[i] - to[i]) * (from[i] - to[i]));
  return std::sqrt(sum);
}

uint32_t plain_point(DescriptorRow a, DescriptorRow b) {
  return static_cast<uint32_t>(std::floor(plain_point_unrounded(a, b) + 0.5));
}

double plain_grey_unrounded(DescriptorRow a, DescriptorRow b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return 256 * sum / static_cast<double>(a.size());
}

uint32_t plain_grey(DescriptorRow a, DescriptorRow b) {
  return static_cast<uint32_t>(std::floor(plain_grey_unrounded(a, b) + 0.5));
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
