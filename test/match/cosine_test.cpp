#include <algorithm>
#include <cstring>
#include <utility>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "database/imported.h"
#include "match/checks.h"
#include "match/lsh.h"

using namespace vpr;
using test::Vectors;

namespace {

Vectors make_vectors(const std::vector<std::vector<int>>& rows) {
  Vectors vectors{{ElementType::int8, rows.front().size()}, {}};
  for (const auto& row : rows)
    for (const int number : row) vectors.bytes.push_back(static_cast<uint8_t>(number));
  return vectors;
}

// A sequence: the values of every frame are near those of the previous one.
Vectors walk_vectors(size_t count, size_t length, uint64_t seed) {
  RandomEngine engine(seed);
  const auto below = [&](uint64_t bound) { return static_cast<int>(uniform_below(engine, bound)); };
  std::vector<std::vector<int>> rows;
  std::vector<int> row(length);
  for (int& number : row) number = below(255) - 127;
  for (size_t i = 0; i < count; ++i) {
    for (int& number : row) number = std::clamp(number + below(61) - 30, -128, 127);
    rows.push_back(row);
  }
  return make_vectors(rows);
}

// The same sequence as 16-bit integers, by import.
Vectors wide_walk(size_t count, size_t length, uint64_t seed) {
  const Vectors narrow = walk_vectors(count, length, seed);
  Vectors wide{{ElementType::int16, length}, {}};
  std::vector<double> row(length);
  std::vector<int16_t> numbers(length);
  for (size_t i = 0; i < count; ++i) {
    for (size_t x = 0; x < length; ++x)
      row[x] = static_cast<int8_t>(narrow.bytes[i * length + x]) + 0.25;
    quantize_numbers(row, std::span(numbers));
    const auto* bytes = reinterpret_cast<const uint8_t*>(numbers.data());
    wide.bytes.insert(wide.bytes.end(), bytes, bytes + 2 * length);
  }
  return wide;
}

uint32_t distance(const std::vector<int>& a, const std::vector<int>& b) {
  const Vectors both = make_vectors({a, b});
  const uint32_t found = frame_distance(both.span().rows, 0, 1);
  CHECK(reference_distance(both.span().rows, 0, both.span().rows, 1) == found);
  CHECK(frame_distance(both.span().rows, 1, 0) == found);
  return found;
}

}  // namespace

TEST_CASE("cosine distances equal values computed by hand") {
  CHECK(distance({3, 4}, {6, 8}) == 0);              // the same direction
  CHECK(distance({3, 4}, {-3, -4}) == 65535);        // the opposite direction
  CHECK(distance({1, 0}, {0, 127}) == 32768);        // a right angle: 32767.5, rounded up
  CHECK(distance({1, 0}, {1, 1}) == 9597);           // 32767.5 * (1 - sqrt(1/2)) = 9597.4
  CHECK(distance({3, 4, 0}, {4, 3, 0}) == 1311);     // 32767.5 * (1 - 24/25) = 1310.7
  CHECK(distance({0, 0}, {5, 5}) == 32768);          // no direction
  CHECK(distance({-128, -128}, {-128, -128}) == 0);  // the largest values
  CHECK(distance({-128}, {127}) == 65535);
}

TEST_CASE("cosine distances equal the reference implementation, for any length and SIMD target") {
  for (const bool is_wide : {false, true})
    for (const size_t length : {1, 2, 15, 16, 17, 31, 32, 33, 64, 127, 256, 512, 1001}) {
      const auto make = is_wide ? wide_walk : walk_vectors;
      const ElementType type = is_wide ? ElementType::int16 : ElementType::int8;
      const Vectors one = make(77, length, 1);
      const Vectors two = make(9, length, 2);
      Vectors query = make(7, length, 3);
      const size_t bytes = query.bytes.size() / 7;
      std::copy_n(one.bytes.begin(), bytes, query.bytes.begin());
      std::fill_n(query.bytes.begin() + static_cast<ptrdiff_t>(bytes), bytes, uint8_t{0});
      test::check_distances(std::vector{one.span(), two.span()}, query.span(), 65535);
      CHECK(distance_of(type).unit.size * 65535 == Approx(2));  // of opposite directions
    }
}

TEST_CASE("the longest vectors of the largest 8-bit integers have exact products") {
  for (const auto& [a, b] : {std::pair(-128, -127), std::pair(127, -128), std::pair(-128, 127)}) {
    const auto made = [](int number) {
      return make_vectors(
          {std::vector<int>(kMaxIntegers, number), std::vector<int>(kMaxIntegers, number / 2)});
    };
    const Vectors train = made(a);
    const Vectors query = made(b);
    const DescribedFrames span = train.span();
    for (const std::string& target : simd_targets()) {
      const test::ChosenTarget chosen(target);
      INFO(target << ", " << a << " and " << b);
      const FrameDistances distances = frame_distances({&span, 1}, query.span());
      const std::vector<uint32_t> order = {0, 1, 0, 1, 1};
      std::vector<uint16_t> tile(order.size() * 8);
      distances.tile(order, 0, 2, tile.data(), 8);
      for (const uint16_t distance : {tile[0], tile[1], tile[8], tile[33]})
        CHECK(distance == ((a < 0) == (b < 0) ? 0 : 65535));
    }
  }
}

TEST_CASE(
    "the largest vectors of 16-bit integers have exact products, and longer ones are refused") {
  const auto vectors = [](const std::vector<int16_t>& numbers, size_t length) {
    Vectors made{{ElementType::int16, length}, {}};
    made.bytes.resize(2 * numbers.size());
    std::memcpy(made.bytes.data(), numbers.data(), made.bytes.size());
    return made;
  };
  std::vector<int16_t> numbers(64, 0);
  // length 46339.5; in the opposite order, the product is negative
  numbers[0] = numbers[1] = 32767;
  numbers[32] = numbers[33] = -32767;
  const Vectors longest = vectors(numbers, 32);
  for (const std::string& target : simd_targets()) {
    const test::ChosenTarget chosen(target);
    const DescribedFrames train = longest.span();
    const FrameDistances distances = frame_distances({&train, 1}, longest.span());
    std::vector<uint16_t> row(8);
    const uint32_t query = 0;
    distances.tile({&query, 1}, 0, 2, row.data(), 0);
    CHECK(row[0] == 0);
    CHECK(row[1] == 65535);
  }
  numbers[2] = 300;
  const Vectors longer = vectors(numbers, 32);
  const DescribedFrames train = longer.span();
  CHECK(test::error_text([&] {
          frame_distances({&train, 1}, longest.span());
        }) == "the vector of frame 0 is longer than 46340");
  CHECK(test::error_kind([&] { frame_distances({}, longer.span()); }) == ErrorKind::data);
}

TEST_CASE("the mean distance to all vectors equals the mean of their distances up to rounding") {
  const bool is_wide = GENERATE(false, true);
  const auto make = is_wide ? wide_walk : walk_vectors;
  const Vectors one = make(200, 40, 4);
  const std::vector<size_t> unreadable = {3, 99};
  const Vectors query = make(20, 40, 5);
  test::check_means(one.span(unreadable), query.span());
}

TEST_CASE("every exact method yields the sums of vector distances") {
  const Vectors one = walk_vectors(60, 24, 6);
  const Vectors two = walk_vectors(37, 24, 7);
  const Vectors query = walk_vectors(45, 24, 8);
  const std::vector<size_t> unreadable = {20};
  const std::vector<DescribedFrames> train = {one.span(unreadable), two.span()};
  const FrameDistances distances = frame_distances(train, query.span());
  for (const size_t length : {1, 7, 20}) {
    test::Cells expected;
    for (size_t s = 0; s < 2; ++s)
      for (size_t j = 0; j + length <= 45; ++j)
        for (size_t i = 0; i + length <= train[s].rows.size(); ++i)
          if (s == 1 || i + length <= 20 || i > 20)
            expected[{j, s, i}] =
                reference_window_distance(train[s].rows, i, query.span().rows, j, length);
    for (const SequenceMethod& method : exact_methods())
      CHECK(test::cells_of(distances, test::by_method(method, length)) == expected);
    const MatchSettings hashed{length, size_t{1} << 30};
    CHECK(test::error_text([&] { match_lsh(distances, hashed, {}, [](const ScoreRow&) {}); }) ==
          "lsh needs raw distances of binary descriptors; use fastable");
  }
}

TEST_CASE("z-scores of vectors equal the reference implementation") {
  const bool is_wide = GENERATE(false, true);
  const auto make = is_wide ? wide_walk : walk_vectors;
  const Vectors one = make(80, 32, 9);
  const Vectors query = make(50, 32, 10);
  test::check_zscores(one.span(), query.span(), 5);
}

TEST_CASE("vectors cannot be compared with codes, and too long vectors are refused") {
  const Vectors vectors = walk_vectors(3, 176, 11);
  const std::vector<LdbCode> codes = test::random_codes(3, 1);
  const DescribedFrames train{codes, {}};
  CHECK(test::error_kind([&] { frame_distances({&train, 1}, vectors.span()); }) == ErrorKind::data);
  const Vectors longest{{ElementType::int8, 131'072}, {}};
  const Vectors allowed{{ElementType::int8, 131'071}, {}};
  CHECK(test::error_kind([&] { frame_distances({}, longest.span()); }) == ErrorKind::data);
  CHECK_FALSE(test::error_kind([&] { frame_distances({}, allowed.span()); }));
}
