// The exclusion zone of a sequence.
#include "decide/elsewhere.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "match/plain.h"
#include "support.h"

using namespace vpr;

namespace {

bool can_read(const DescriptorSpan& walk, size_t frame) {
  return !std::binary_search(walk.unreadable.begin(), walk.unreadable.end(), frame);
}

// Means over all pairs of readable frames, and over those k apart.
size_t slow_half_width(const DescriptorSpan& walk) {
  const size_t frames = walk.rows.size();
  const auto mean = [&](const auto& is_pair) {
    double sum = 0;
    double count = 0;
    for (size_t i = 0; i < frames; ++i)
      for (size_t j = i + 1; j < frames; ++j) {
        if (!can_read(walk, i) || !can_read(walk, j) || !is_pair(i, j)) continue;
        sum += plain_hamming(walk.rows[i], walk.rows[j]);
        ++count;
      }
    return count == 0 ? -1 : sum / count;
  };
  const double typical = mean([](size_t, size_t) { return true; });
  for (size_t k = 1; k < frames; ++k)
    if (mean([&](size_t i, size_t j) { return j == i + k; }) >= typical / 2) return k;
  return frames;
}

}  // namespace

TEST_CASE("the exclusion zone extends to half of the average difference") {
  // Four frames of one place, then four of another one that differs in all bits of one or two
  // bytes.
  std::vector<LdbCode> codes(8, LdbCode{});
  for (size_t i = 4; i < 8; ++i) codes[i][0] = 0xff;
  // 16 of 28 pairs differ by 8 bits: 32/7 on average. 1, 2, 3 apart: 8/7, 16/6, 24/5 bits.
  CHECK(half_width({codes, {}}) == 2);
  CHECK(half_width({std::vector<LdbCode>(5, LdbCode{}), {}}) == 1);  // equal codes
  for (const int bits : {10, 60, 300}) {
    const auto walk = test::walk_codes(90, 4, bits);
    CHECK(half_width({walk, {}}) == slow_half_width({walk, {}}));
  }
}
