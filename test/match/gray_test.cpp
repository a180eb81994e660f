// Distances of images: mean absolute differences.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "match/checks.h"

using namespace vpr;
using test::Vectors;

namespace {

// A sequence: every image is near the previous one.
Vectors walk(size_t count, size_t pixels, uint64_t seed) {
  RandomEngine engine(seed);
  Vectors pictures{{ElementType::gray_levels, pixels}, {}};
  std::vector<int> row(pixels);
  for (int& level : row) level = static_cast<int>(uniform_below(engine, 256));
  for (size_t i = 0; i < count; ++i) {
    for (int& level : row)
      level = std::clamp(level + static_cast<int>(uniform_below(engine, 61)) - 30, 0, 255);
    for (const int level : row) pictures.bytes.push_back(static_cast<uint8_t>(level));
  }
  return pictures;
}

uint32_t gray_distance(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  CHECK(distance_of(ElementType::gray_levels).pair(a, b) ==
        reference_distance(ElementType::gray_levels, a, b));
  CHECK(distance_of(ElementType::gray_levels).pair(a, b) ==
        distance_of(ElementType::gray_levels).pair(b, a));
  return distance_of(ElementType::gray_levels).pair(a, b);
}

}  // namespace

TEST_CASE("distances of images equal values computed by hand") {
  CHECK(gray_distance({7}, {7}) == 0);
  CHECK(gray_distance({0, 0}, {255, 255}) == 65280);
  CHECK(gray_distance({10, 20}, {13, 19}) == 512);    // a mean of 2
  CHECK(gray_distance({1, 0, 0}, {0, 0, 0}) == 85);   // 85.33
  CHECK(gray_distance({2, 0, 0}, {0, 0, 0}) == 171);  // 170.67
  std::vector<uint8_t> one(512, 0);
  one[0] = 1;
  CHECK(gray_distance(one, std::vector<uint8_t>(512, 0)) == 1);  // a tie, rounded up
}

TEST_CASE("distances of images equal the reference implementation, on every SIMD target") {
  for (const size_t pixels : {1, 63, 64, 65, 200, 2048}) {
    const Vectors one = walk(77, pixels, 1);
    const Vectors two = walk(9, pixels, 2);
    const Vectors query = walk(5, pixels, 3);
    test::check_distances(std::vector{one.span(), two.span()}, query.span(), 65280);
  }
  CHECK(distance_of(ElementType::gray_levels).unit.size * 65280 == 255);
}

TEST_CASE("the mean distance to all images equals the mean of their distances up to rounding") {
  const Vectors one = walk(200, 64, 4);
  const Vectors query = walk(20, 64, 5);
  const std::vector<size_t> unreadable = {3, 99};
  test::check_means(one.span(unreadable), query.span());
}

TEST_CASE("components of images are sums over landmarks") {
  const Vectors landmarks = walk(30, 64, 6);
  const Vectors asked = walk(5, 64, 7);
  RandomEngine engine(8);
  std::vector<ComponentValues> weights(30);
  for (ComponentValues& weight : weights)
    for (double& value : weight)
      value = std::ldexp(static_cast<double>(uniform_below(engine, 2001)) - 1000, -20);
  const Projector project =
      distance_of(ElementType::gray_levels).projector(landmarks.span().rows, weights);
  for (size_t j = 0; j < 5; ++j) {
    const ComponentValues found = project(asked.span().rows[j]);
    for (size_t k = 0; k < kMaxComponents; ++k) {
      double sum = 0;
      for (size_t i = 0; i < 30; ++i)
        sum += weights[i][k] * reference_unrounded(ElementType::gray_levels,
                                                   landmarks.span().rows[i], asked.span().rows[j]);
      CHECK(found[k] == sum);  // exact
    }
  }
}

TEST_CASE("z-scores of images equal the reference implementation") {
  const Vectors one = walk(80, 64, 9);
  const Vectors query = walk(50, 64, 10);
  test::check_zscores(one.span(), query.span(), 1);
}
