// Precomputed distances.
#include <limits>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "match/components.h"
#include "match/precomputed_distances.h"
#include "match/zscores.h"
#include "support.h"

using namespace vpr;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<uint32_t> row_of(const PrecomputedDistances& precomputed, size_t query) {
  std::vector<uint16_t> row(precomputed.references());
  precomputed.read(query, 0, row.size(), row.data());
  std::vector<uint32_t> distances(row.begin(), row.end());
  for (size_t i = 0; i < row.size(); ++i) CHECK(precomputed.distance(query, i) == distances[i]);
  return distances;
}

PrecomputedDistances of(const std::vector<double>& values, const std::vector<size_t>& shape,
                        const ScoreFormat& format = {}) {
  const test::TemporaryFolder folder;
  test::write_array(folder / "s.npy", values, shape);
  return {ScoreFile(folder / "s.npy", format), {}};
}

std::vector<uint8_t> numbers(size_t first, size_t count) {
  std::vector<uint8_t> rows;
  append_frame_numbers(rows, first, count);
  return rows;
}

constexpr DescriptorShape kShape = {ElementType::frame_numbers, 1};

}  // namespace

TEST_CASE("scores become integers from the best to the worst") {
  // Distances keep their 0, and 3 is the largest: the unit is 3/65535.
  const PrecomputedDistances distances = of({1.5, 3, 0.75, 2}, {2, 2});
  CHECK(distances.units().best == 0);
  CHECK(distances.units().unit == 3.0 / 65535);
  CHECK_FALSE(distances.units().is_exact);
  CHECK(row_of(distances, 0) == std::vector<uint32_t>{32768, 65535});  // 32767.5, rounded up
  CHECK(row_of(distances, 1) == std::vector<uint32_t>{16384, 43690});
  // The best similarity is distance 0.
  const PrecomputedDistances similar = of({0.5, -0.5, 0, 0.25}, {2, 2}, {true, false, {}});
  CHECK(similar.units().best == 0.5);
  CHECK(row_of(similar, 0) == std::vector<uint32_t>{0, 65535});
  CHECK(row_of(similar, 1) == std::vector<uint32_t>{32768, 16384});
  // Negative distances start from the smallest.
  CHECK(row_of(of({-1, 1}, {1, 2}), 0) == std::vector<uint32_t>{0, 65535});
  // The smallest difference of doubles.
  CHECK(row_of(of({1.5, 0, 5e-324}, {1, 3}), 0) == std::vector<uint32_t>{65535, 0, 0});
  CHECK(row_of(of({0, 5e-324}, {1, 2}), 0) == std::vector<uint32_t>{0, 0});
  // Equal scores have equal distances.
  CHECK(row_of(of({0, 0}, {1, 2}), 0) == std::vector<uint32_t>{0, 0});
}

TEST_CASE("integers with a range of 16 bits are exact") {
  test::write_array("s.npy", std::vector<int32_t>{3, 700, 41, 65535}, {2, 2});
  const PrecomputedDistances precomputed(ScoreFile("s.npy", {}), {});
  CHECK(precomputed.units().is_exact);
  CHECK(precomputed.units().largest == 65535);
  CHECK(row_of(precomputed, 0) == std::vector<uint32_t>{3, 700});
  test::write_array("s.npy", std::vector<int32_t>{3, 65536}, {1, 2});
  CHECK_FALSE(PrecomputedDistances(ScoreFile("s.npy", {}), {}).units().is_exact);
  test::write_array("s.npy", std::vector<uint8_t>{3, 9, 5}, {1, 3});
  CHECK(row_of({ScoreFile("s.npy", {true, false, {}}), {}}, 0) == std::vector<uint32_t>{6, 0, 4});
}

TEST_CASE("a missing score has the largest distance") {
  const PrecomputedDistances precomputed = of(
      {1, kNan, 7, kInfinity, kNan, kNan, kNan, 7, kNan, 2, kNan, 4}, {3, 4}, {false, false, 7.0});
  CHECK(precomputed.empty_queries() == std::vector<size_t>{1});
  CHECK(precomputed.empty_references() == std::vector<size_t>{2});
  CHECK(row_of(precomputed, 0) == std::vector<uint32_t>{16384, 65535, 65535, 65535});
  CHECK(row_of(precomputed, 2) == std::vector<uint32_t>{65535, 32768, 65535, 65535});
  // The same matrix by columns.
  const PrecomputedDistances turned = of(
      {1, kNan, kNan, kNan, kNan, 2, 7, kNan, kNan, kInfinity, 7, 4}, {4, 3}, {false, true, 7.0});
  CHECK(turned.empty_queries() == precomputed.empty_queries());
  CHECK(turned.empty_references() == precomputed.empty_references());
  CHECK(row_of(turned, 2) == row_of(precomputed, 2));
}

TEST_CASE("invalid matrices are refused") {
  const auto kind = [](const std::vector<double>& values, const std::vector<size_t>& shape,
                       const ScoreFormat& format = {}) {
    return test::error_kind([&] { of(values, shape, format); });
  };
  CHECK(kind({kNan, kNan}, {1, 2}) == ErrorKind::data);
  CHECK(kind({1, 2}, {2}) == ErrorKind::data);
  CHECK(kind({}, {0, 4}) == ErrorKind::data);
  CHECK(kind({1, -kInfinity}, {1, 2}) == ErrorKind::data);
  CHECK(kind({1, kInfinity}, {1, 2}, {true, false, {}}) == ErrorKind::data);
  CHECK(kind({1.5e308, -1e308}, {1, 2}) == ErrorKind::data);  // their difference is infinite
  CHECK(test::has(test::error_text([&] { of({1, -kInfinity}, {1, 2}); }), "--missing"));
  CHECK(test::error_kind([] { ScoreFile("/off_map.npy", {}); }) == ErrorKind::input);
}

TEST_CASE("tiles equal distances of single pairs, for any frames and order") {
  RandomEngine engine(1);
  constexpr size_t kQueries = 21;
  constexpr size_t kReferences = 1100;
  std::vector<double> scores(kQueries * kReferences);
  for (double& score : scores) score = uniform_unit(engine);
  for (const bool train_first : {false, true}) {
    const PrecomputedDistances precomputed =
        train_first ? of(scores, {kReferences, kQueries}, {true, true, {}})
                    : of(scores, {kQueries, kReferences}, {true, false, {}});
    const std::vector<uint8_t> one = numbers(40, 13);
    const std::vector<uint8_t> two = numbers(0, 1090);
    const std::vector<uint8_t> asked = numbers(0, kQueries);
    const std::vector<size_t> gap = {5};
    const std::vector<DescribedFrames> train = {{{kShape, one}, gap}, {{kShape, two}, {}}};
    const DescribedFrames query{{kShape, asked}, {}, &precomputed};
    const FrameDistances distances = frame_distances(train, query);
    CHECK(distances.train_frames == 1103);
    CHECK(distances.readable_frames == 1102);
    const std::vector<uint32_t> order = {20, 0, 7};
    std::vector<uint16_t> tile(order.size() * 1200, 7);
    distances.tile(order, 8, 1103, tile.data(), 1200);
    for (size_t t = 0; t < order.size(); ++t)
      for (size_t i = 8; i < 1103; ++i) {
        const size_t reference = i < 13 ? 40 + i : i - 13;
        REQUIRE(tile[t * 1200 + (i - 8)] == precomputed.distance(order[t], reference));
      }
    uint64_t total = 0;
    for (size_t i = 0; i < 1103; ++i)
      if (i != 5) total += precomputed.distance(3, i < 13 ? 40 + i : i - 13);
    CHECK(row_mean(distances, 3) ==
          static_cast<double>(total) / static_cast<double>(distances.readable_frames));
  }
}

TEST_CASE("a matrix has no distances between training frames") {
  const std::vector<uint8_t> rows = numbers(0, 9);
  const DescribedFrames walk{{kShape, rows}, {}};
  CHECK(test::error_kind([&] { frame_distances({&walk, 1}, walk); }) == ErrorKind::usage);
  CHECK(frame_distance(walk.rows, 3, 3) == 0);
  CHECK(frame_distance(walk.rows, 3, 4) == 65535);
}

TEST_CASE("z-scores of precomputed Hamming distances equal those of the codes") {
  const std::vector<LdbCode> train = test::walk_codes(90, 1);
  const std::vector<LdbCode> query = test::walk_codes(40, 2);
  const DescribedFrames walk{{train}, {}};
  FrameDistances coded = frame_distances({&walk, 1}, {{query}, {}});
  std::vector<int32_t> matrix;
  for (size_t j = 0; j < query.size(); ++j)
    for (size_t i = 0; i < train.size(); ++i)
      matrix.push_back(static_cast<int32_t>(
          hamming_distance(DescriptorRows(query)[j], DescriptorRows(train)[i])));
  matrix.push_back(1386);  // an unused frame, so that both have the same largest distance
  matrix.resize(41 * 90, 0);
  test::write_array("s.npy", matrix, {41, 90});
  const PrecomputedDistances precomputed(ScoreFile("s.npy", {}), {});
  const std::vector<uint8_t> references = numbers(0, 90);
  const std::vector<uint8_t> asked = numbers(0, 40);
  const DescribedFrames known{{kShape, references}, {}};
  FrameDistances read = frame_distances({&known, 1}, {{kShape, asked}, {}, &precomputed});
  REQUIRE(read.largest == coded.largest);
  for (const bool offline : {false, true}) {
    ScoreBasis basis{{}, offline, 0, std::vector<float>(90, 0), 900, no_components(90)};
    basis.settings.keyframe_change = 0;
    const FrameDistances a = zscores(coded, basis, {});
    const FrameDistances b = zscores(read, basis, {});
    for (uint32_t frame = 0; frame < 40; ++frame) {
      std::vector<uint16_t> left(96, 0);
      std::vector<uint16_t> right(96, 0);
      a.start_row(frame);
      b.start_row(frame);
      a.tile({&frame, 1}, 0, 90, left.data(), 96);
      b.tile({&frame, 1}, 0, 90, right.data(), 96);
      left.resize(90);
      right.resize(90);
      REQUIRE(left == right);
    }
  }
}
