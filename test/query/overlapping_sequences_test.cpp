// Detection of training sequences of the same place.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "query/exclusion_zones.h"
#include "support.h"

using namespace vpr;

namespace {

using Walk = std::vector<LdbCode>;
using Pairs = std::vector<std::pair<size_t, size_t>>;

// The same frames in another light: one bit in eight differs.
Walk seen_again(Walk walk, uint64_t seed) {
  RandomEngine engine(seed);
  for (LdbCode& code : walk)
    for (size_t bit = 0; bit < kLdbBits; ++bit)
      if (uniform_below(engine, 8) == 0) code[bit / 8] ^= static_cast<uint8_t>(1U << (bit % 8));
  return walk;
}

Pairs find(const std::vector<Walk>& walks, size_t most_pairs = size_t{1} << 32) {
  std::vector<DescribedFrames> spans;
  std::vector<uint32_t> widths;
  for (const Walk& walk : walks) {
    spans.push_back({walk, {}});
    widths.push_back(static_cast<uint32_t>(exclusion_radius(spans.back())));
  }
  return find_overlapping_sequences(spans, widths, {}, most_pairs);
}

}  // namespace

TEST_CASE("sequences of different places do not overlap, two sequences of one place do") {
  const Walk first = test::walk_codes(120, 1);
  const Walk other = test::walk_codes(110, 2);
  CHECK(find({first}).empty());
  CHECK(find({first, other}).empty());
  CHECK(find({first, other, seen_again(first, 3)}) == Pairs{{0, 2}});
}

TEST_CASE("a sequence through two places overlaps with a sequence of each, which do not overlap") {
  const Walk hall = test::walk_codes(80, 1);
  const Walk stairs = test::walk_codes(90, 2);
  Walk through = seen_again(hall, 3);
  const Walk second = seen_again(stairs, 4);
  through.insert(through.end(), second.begin(), second.end());
  CHECK(find({hall, through, stairs}) == Pairs{{0, 1}, {1, 2}});
}

TEST_CASE("too short sequences do not overlap") {
  const Walk walk = test::walk_codes(60, 1);
  CHECK(find({walk, Walk(walk.begin(), walk.begin() + 1)}).empty());
  CHECK(find({Walk(walk.begin(), walk.begin() + 7), walk}).empty());
}

TEST_CASE("long sequences are compared in parts") {
  const Walk walk = test::walk_codes(2500, 1);
  const Walk other = test::walk_codes(2200, 2);
  CHECK(find({walk, seen_again(walk, 3), other}, 1) == Pairs{{0, 1}});
}
