#include <algorithm>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "base/simd.h"
#include "matching/hamming_kernels.h"
#include "matching/plain.h"
#include "support.h"

using namespace vpr;

TEST_CASE("the plain Hamming distance counts bits, not bytes") {
  LdbCode a{};
  LdbCode b{};
  CHECK(plain_hamming(a, b) == 0);
  a[0] = 0b1011;
  b[0] = 0b0001;
  b[175] = 0x80;
  CHECK(plain_hamming(a, b) == 3);
  a.fill(0xff);
  b.fill(0);
  CHECK(plain_hamming(a, b) == 1408);
}

TEST_CASE("every SIMD target counts as the plain distance does") {
  const std::vector<LdbCode> train = test::random_codes(29, 1);
  std::vector<LdbCode> queries = test::random_codes(5, 2);
  queries.push_back(train[13]);
  queries.emplace_back().fill(0xff);  // padding bits set: counted too
  queries.emplace_back().fill(0);
  const CodeSpan span{train, {}};
  const TrainCodes codes = make_train_codes(std::span(&span, 1));
  REQUIRE(codes.blocks.size() == 4);
  const QueryCodes query = make_query_codes({queries, {}});
  for (const HammingKernels& kernels : test::all_kernels()) {
    INFO(kernels.target);
    std::vector<uint16_t> tile(queries.size() * 40, 0xffff);
    kernels.tile_distances(query.words.data(), queries.size(), codes.blocks.data(), 4, tile.data(),
                           40);
    for (size_t q = 0; q < queries.size(); ++q) {
      std::vector<uint16_t> row(32, 0xffff);
      kernels.row_distances(query.words[q], codes.blocks.data(), 4, row.data());
      for (size_t i = 0; i < train.size(); ++i) {
        REQUIRE(row[i] == plain_hamming(train[i], queries[q]));
        REQUIRE(tile[q * 40 + i] == row[i]);
      }
      REQUIRE(tile[q * 40 + 32] == 0xffff);  // nothing written beyond the blocks
    }
  }
}

TEST_CASE("every SIMD target slides, adds and searches as a loop does, for any count") {
  RandomEngine engine(3);
  for (const HammingKernels& kernels : test::all_kernels()) {
    INFO(kernels.target);
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
      kernels.slide(before.data(), in.data(), out.data(), slid.data(), count);
      kernels.accumulate(added.data(), in.data(), count);
      for (size_t i = 0; i < count; ++i) {
        REQUIRE(slid[i] == before[i] + in[i] - out[i]);
        REQUIRE(added[i] == before[i] + in[i]);
      }
      REQUIRE(slid[count] == 7);
      if (count > 0) {
        REQUIRE(kernels.minimum(before.data(), count) ==
                *std::min_element(before.begin(), before.end()));
        REQUIRE(kernels.maximum(before.data(), count) ==
                *std::max_element(before.begin(), before.end()));
      }
      const uint32_t limit = 5030;
      for (size_t begin = 0; begin <= count; begin += 3) {
        const auto found = std::find_if(before.begin() + ptrdiff_t(begin), before.end(),
                                        [&](uint32_t v) { return v < limit; });
        REQUIRE(kernels.find_below(before.data(), begin, count, limit) ==
                size_t(found - before.begin()));
      }
    }
  }
}

TEST_CASE("comparisons are unsigned") {
  const std::vector<uint32_t> values(20, 0x80000001U);
  for (const HammingKernels& kernels : test::all_kernels()) {
    CHECK(kernels.find_below(values.data(), 0, 20, 0x80000001U) == 20);
    CHECK(kernels.find_below(values.data(), 0, 20, 0x80000002U) == 0);
    CHECK(kernels.find_below(values.data(), 0, 20, 5) == 20);
    CHECK(kernels.minimum(values.data(), 20) == 0x80000001U);
  }
}

TEST_CASE("an unknown SIMD target is refused with the choices") {
  const std::string text = test::error_text([] { use_simd_target("AVX9"); });
  for (const std::string& target : simd_targets()) CHECK(text.find(target) != std::string::npos);
  CHECK(select_kernels().target == simd_targets().front());
}
