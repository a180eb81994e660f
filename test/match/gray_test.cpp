// Distances of images: mean absolute differences.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "match/components.h"
#include "match/distance_statistics.h"
#include "match/reference.h"
#include "match/zscores.h"
#include "support.h"

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

uint32_t distance(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  CHECK(distance_of(ElementType::gray_levels).pair(a, b) ==
        reference_distance(ElementType::gray_levels, a, b));
  CHECK(distance_of(ElementType::gray_levels).pair(a, b) ==
        distance_of(ElementType::gray_levels).pair(b, a));
  return distance_of(ElementType::gray_levels).pair(a, b);
}

}  // namespace

TEST_CASE("distances of images equal values computed by hand") {
  CHECK(distance({7}, {7}) == 0);
  CHECK(distance({0, 0}, {255, 255}) == 65280);
  CHECK(distance({10, 20}, {13, 19}) == 512);    // a mean of 2
  CHECK(distance({1, 0, 0}, {0, 0, 0}) == 85);   // 85.33
  CHECK(distance({2, 0, 0}, {0, 0, 0}) == 171);  // 170.67
  std::vector<uint8_t> one(512, 0);
  one[0] = 1;
  CHECK(distance(one, std::vector<uint8_t>(512, 0)) == 1);  // a tie, rounded up
}

TEST_CASE("distances of images equal the reference implementation, on every SIMD target") {
  for (const size_t pixels : {1, 63, 64, 65, 200, 2048}) {
    const Vectors one = walk(77, pixels, 1);
    const Vectors two = walk(9, pixels, 2);
    const Vectors query = walk(5, pixels, 3);
    const std::vector<DescribedFrames> train = {one.span(), two.span()};
    for (const std::string& target : simd_targets()) {
      const test::ChosenTarget chosen(target);
      INFO(target << ", " << pixels << " pixels");
      const FrameDistances distances = frame_distances(train, query.span());
      CHECK(distances.largest == 65280);
      CHECK(distance_of(ElementType::gray_levels).unit.size * distances.largest == 255);
      const std::vector<uint32_t> order = {4, 0, 1, 3};
      std::vector<uint16_t> tile(order.size() * 100, 7);
      distances.tile(order, 8, 86, tile.data(), 100);
      for (size_t t = 0; t < order.size(); ++t)
        for (size_t i = 8; i < 86; ++i) {
          const DescriptorRow row = i < 77 ? train[0].rows[i] : train[1].rows[i - 77];
          REQUIRE(tile[t * 100 + i - 8] ==
                  reference_distance(ElementType::gray_levels, row, query.span().rows[order[t]]));
        }
    }
  }
}

TEST_CASE("the mean distance to all images equals the mean of their distances up to rounding") {
  const Vectors one = walk(200, 64, 4);
  const Vectors query = walk(20, 64, 5);
  const std::vector<size_t> unreadable = {3, 99};
  const DescribedFrames train = one.span(unreadable);
  const FrameDistances distances = frame_distances({&train, 1}, query.span());
  for (size_t j = 0; j < 20; ++j) {
    double sum = 0;
    for (size_t i = 0; i < 200; ++i)
      if (i != 3 && i != 99)
        sum += reference_distance(ElementType::gray_levels, train.rows[i], query.span().rows[j]);
    CHECK(row_mean(distances, j) == Approx(sum / 198).margin(0.5));
  }
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
  const DescribedFrames train = one.span();
  TrainStatistics statistics = compute_statistics({&train, 1}, {}, {});
  statistics.components = compute_components({&train, 1}, statistics.typical_distance, {});
  const ScoreBasis basis = make_score_basis({}, false, statistics);
  const ReferenceUpdates updates = reference_updates({&train, 1}, query.span(), basis, {});
  const FrameDistances scores = zscores(frame_distances({&train, 1}, query.span()), basis, {});
  std::vector<uint16_t> row(80);
  std::vector<std::vector<double>> plain;
  for (size_t i = 0; i < 80; ++i)
    plain.push_back(reference_frame_scores(train.rows[i], i, query.span().rows, updates, basis));
  for (uint32_t j = 0; j < 50; ++j) {
    scores.start_row(j);
    scores.tile({&j, 1}, 0, 80, row.data(), 0);
    for (size_t i = 0; i < 80; ++i) {
      const double found = (static_cast<double>(row[i]) - kScoreBias) / kScoreUnit;
      REQUIRE(std::abs(found - plain[i][j]) <= score_tolerance(1));
    }
  }
}
