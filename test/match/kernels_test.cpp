#include <algorithm>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "base/simd.h"
#include "match/checks.h"
#include "match/row_kernels.h"

using namespace vpr;

TEST_CASE("the reference Hamming distance counts bits, not bytes") {
  LdbCode a{};
  LdbCode b{};
  CHECK(reference_hamming(a, b) == 0);
  a[0] = 0b1011;
  b[0] = 0b0001;
  b[175] = 0x80;
  CHECK(reference_hamming(a, b) == 3);
  a.fill(0xff);
  b.fill(0);
  CHECK(reference_hamming(a, b) == 1408);
}

TEST_CASE("every SIMD target counts like the reference implementation") {
  const std::vector<LdbCode> train = test::random_codes(29, 1);
  std::vector<LdbCode> queries = test::random_codes(5, 2);
  queries.push_back(train[13]);
  queries.emplace_back().fill(0xff);  // padding bits that are set count as well
  queries.emplace_back().fill(0);
  const DescribedFrames span{train, {}};
  const std::vector<uint32_t> all = {0, 1, 2, 3, 4, 5, 6, 7};
  REQUIRE(queries.size() == all.size());
  for (const std::string& target : simd_targets()) {
    const test::ChosenTarget chosen(target);
    INFO(target);
    const FrameDistances distances = frame_distances({&span, 1}, {queries, {}});
    std::vector<uint16_t> tile(queries.size() * 40, 0xffff);
    distances.tile(all, 0, 29, tile.data(), 40);
    for (const uint32_t q : all) {
      std::vector<uint16_t> row(32, 0xffff);
      distances.tile({&q, 1}, 0, 29, row.data(), 0);
      for (size_t i = 0; i < train.size(); ++i) {
        REQUIRE(row[i] == reference_hamming(train[i], queries[q]));
        REQUIRE(tile[q * 40 + i] == row[i]);
      }
      REQUIRE(tile[q * 40 + 32] == 0xffff);  // nothing written beyond the blocks
    }
  }
}

TEST_CASE("every SIMD target slides, adds and searches like a loop, for any count") {
  RandomEngine engine(3);
  for (const std::string& target : simd_targets()) {
    const test::ChosenTarget chosen(target);
    INFO(target);
    for (size_t count = 0; count < 70; ++count) {
      std::vector<uint32_t> before(count);
      std::vector<uint16_t> in(count);
      std::vector<uint16_t> out(count);
      for (size_t i = 0; i < count; ++i) {
        before[i] = static_cast<uint32_t>(5000 + engine() % 100);
        in[i] = static_cast<uint16_t>(engine() % 1387);
        out[i] = static_cast<uint16_t>(engine() % 1387);
      }
      std::vector<uint32_t> slid(count + 1, 7);
      std::vector<uint32_t> added = before;
      slide_sums(before.data(), in.data(), out.data(), slid.data(), count);
      add_to_sums(added, in.data());
      for (size_t i = 0; i < count; ++i) {
        REQUIRE(slid[i] == before[i] + in[i] - out[i]);
        REQUIRE(added[i] == before[i] + in[i]);
      }
      REQUIRE(slid[count] == 7);
      if (count > 0) {
        REQUIRE(minimum_of(before) == *std::min_element(before.begin(), before.end()));
        REQUIRE(maximum_of(before) == *std::max_element(before.begin(), before.end()));
      }
      const uint32_t limit = 5030;
      for (size_t begin = 0; begin <= count; begin += 3) {
        const auto found = std::find_if(before.begin() + ptrdiff_t(begin), before.end(),
                                        [&](uint32_t v) { return v < limit; });
        REQUIRE(find_below(before, begin, limit) == size_t(found - before.begin()));
      }
    }
  }
}

TEST_CASE("comparisons are unsigned") {
  const std::vector<uint32_t> values(20, 0x80000001U);
  for (const std::string& target : simd_targets()) {
    const test::ChosenTarget chosen(target);
    CHECK(find_below(values, 0, 0x80000001U) == 20);
    CHECK(find_below(values, 0, 0x80000002U) == 0);
    CHECK(find_below(values, 0, 5) == 20);
    CHECK(minimum_of(values) == 0x80000001U);
  }
}

TEST_CASE("an unknown SIMD target is refused with a list of the known ones") {
  const std::string text = test::error_text([] { use_simd_target("AVX9"); });
  for (const std::string& target : simd_targets()) CHECK(test::has(text, target));
  CHECK(simd_target() == simd_targets().front());
}

TEST_CASE(
    "distances of codes of any length equal the reference implementation, in any range and order") {
  RandomEngine engine(4);
  for (const size_t bits : {1, 63, 64, 65, 256, 1344, 1408, 1409, 8191, 65472}) {
    const DescriptorShape shape{ElementType::bits, bits};
    const auto codes_of = [&](size_t count) {
      std::vector<uint8_t> bytes(count * shape.row_bytes(), 0);
      for (size_t i = 0; i < count; ++i)
        for (size_t bit = 0; bit < bits; ++bit)
          if ((engine() & 1) != 0)
            bytes[i * shape.row_bytes() + bit / 8] |= static_cast<uint8_t>(1 << bit % 8);
      return bytes;
    };
    const std::vector<uint8_t> train = codes_of(21);
    std::vector<uint8_t> query = codes_of(4);
    std::copy_n(train.begin(), shape.row_bytes(), query.begin());
    const DescribedFrames span{{shape, train}, {}};
    const DescribedFrames asked{{shape, query}, {}};
    CHECK(largest_distance(shape) == bits);
    test::check_distances({&span, 1}, asked, static_cast<uint32_t>(bits));
    CHECK(hamming_distance(span.rows[9], asked.rows[3]) ==
          reference_hamming(span.rows[9], asked.rows[3]));
  }
}

TEST_CASE("descriptors of different shapes are refused") {
  const std::vector<uint8_t> bytes(8192, 0);
  const DescribedFrames train{{{ElementType::bits, 64}, std::span(bytes).first(16)}, {}};
  const DescribedFrames other{{{ElementType::bits, 128}, std::span(bytes).first(16)}, {}};
  CHECK(test::error_text([&] {
          frame_distances({&train, 1}, other);
        }) == "descriptors of 64 and of 128 elements can't be compared");
  const DescribedFrames longest{{{ElementType::bits, 65473}, bytes}, {}};
  CHECK(test::error_kind([&] { frame_distances({&longest, 1}, longest); }) == ErrorKind::data);
}
