// Euclidean distances of points.
#include <cmath>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "database/imported.h"
#include "match/checks.h"

using namespace vpr;
using test::Vectors;

namespace {

void append(Vectors& points, const std::vector<int16_t>& row) {
  const auto* first = reinterpret_cast<const uint8_t*>(row.data());
  points.bytes.insert(points.bytes.end(), first, first + 2 * row.size());
}

// A sequence: every point is near the previous one, none farther than 30000 from the origin.
Vectors point_walk(size_t count, size_t length, uint64_t seed) {
  RandomEngine engine(seed);
  Vectors points{{ElementType::points16, length}, {}};
  const int most = static_cast<int>(30000 / std::sqrt(static_cast<double>(length)));
  std::vector<int> row(length);
  for (int& x : row) x = static_cast<int>(uniform_below(engine, 2 * most + 1)) - most;
  for (size_t i = 0; i < count; ++i) {
    std::vector<int16_t> numbers;
    for (int& x : row) {
      x = std::clamp(x + static_cast<int>(uniform_below(engine, most / 5 + 1)) - most / 10, -most,
                     most);
      numbers.push_back(static_cast<int16_t>(x));
    }
    append(points, numbers);
  }
  return points;
}

uint32_t point_distance(const std::vector<int16_t>& a, const std::vector<int16_t>& b) {
  Vectors points{{ElementType::points16, a.size()}, {}};
  append(points, a);
  append(points, b);
  const DescriptorRows rows = points.span().rows;
  CHECK(distance_of(ElementType::points16).pair(rows[0], rows[1]) ==
        reference_distance(ElementType::points16, rows[0], rows[1]));
  CHECK(distance_of(ElementType::points16).pair(rows[0], rows[1]) ==
        distance_of(ElementType::points16).pair(rows[1], rows[0]));
  return distance_of(ElementType::points16).pair(rows[0], rows[1]);
}

}  // namespace

TEST_CASE("distances of points equal values computed by hand") {
  CHECK(point_distance({3, 4}, {0, 0}) == 5);
  CHECK(point_distance({1, 1}, {0, 0}) == 1);        // 1.41
  CHECK(point_distance({1, 1, 1}, {0, 0, 0}) == 2);  // 1.73
  CHECK(point_distance({-7, 2}, {-7, 2}) == 0);
  CHECK(point_distance({32767, 0}, {-32767, 0}) == 65534);
}

TEST_CASE("distances of points equal the reference implementation, on every SIMD target") {
  for (const size_t length : {1, 31, 32, 33, 200, 4096}) {
    const Vectors one = point_walk(77, length, 1);
    const Vectors two = point_walk(9, length, 2);
    const Vectors query = point_walk(6, length, 3);
    const std::vector<size_t> gap = {3};
    const std::vector<DescribedFrames> train = {one.span(gap), two.span()};
    test::check_distances(train, query.span(), 65534);
    test::check_means(train[0], query.span());
  }
}

TEST_CASE("a point that is too long for exact products is refused") {
  Vectors far{{ElementType::points16, 3}, {}};
  append(far, {32767, 32767, 32767});
  const DescribedFrames span = far.span();
  CHECK(test::error_kind([&] { frame_distances({&span, 1}, span); }) == ErrorKind::data);
}

TEST_CASE("z-scores of points equal the reference implementation") {
  const Vectors train = point_walk(120, 40, 5);
  const Vectors query = point_walk(30, 40, 6);
  test::check_zscores(train.span(), query.span(), 1);
}
