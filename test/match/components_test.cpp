// Principal components of training frames: by hand, and equal results for any number of threads.
#include "match/components.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "examples.h"
#include "reference/reference.h"
#include "support.h"

using namespace vpr;

namespace {

std::vector<double> distances_within(const DescriptorRows& rows) {
  std::vector<double> distances;
  for (size_t a = 0; a < rows.size(); ++a)
    for (size_t b = 0; b < rows.size(); ++b)
      distances.push_back(reference_distance(rows, a, rows, b));
  return distances;
}

// Sums over all landmarks, as in the header.
ComponentValues reference_components(const TrainComponents& components, DescriptorRow row) {
  ComponentValues values = {};
  const ElementType element = components.shape.element;
  for (size_t l = 0; l < components.landmarks.size(); ++l)
    for (size_t k = 0; k < kMaxComponents; ++k)
      values[k] +=
          components.weights[l][k] * reference_unrounded(element, components.rows()[l], row);
  return values;
}

// Frames alternate between two places, whose codes differ in 600 bits; each frame has 20 bits of
// its own.
std::vector<LdbCode> two_places(size_t count) {
  RandomEngine engine(3);
  std::vector<LdbCode> codes(count, LdbCode{});
  for (size_t i = 0; i < count; ++i) {
    if (i % 2 == 1) std::fill_n(codes[i].begin(), 75, uint8_t{0xff});
    for (int n = 0; n < 20; ++n) {
      const uint64_t bit = uniform_below(engine, kLdbBits);
      codes[i][bit / 8] = static_cast<uint8_t>(codes[i][bit / 8] ^ 1 << bit % 8);
    }
  }
  return codes;
}

double shared(const TrainComponents& components, size_t j, size_t k) {
  double sum = 0;
  for (const ComponentValues& weights : components.weights) sum += weights[j] * weights[k];
  return sum;
}

}  // namespace

TEST_CASE("the first component separates two places") {
  const std::vector<LdbCode> codes = two_places(60);
  const DescribedFrames train{codes, {}};
  const TrainComponents components = compute_components({&train, 1}, 0, {});
  REQUIRE(components.landmarks.size() == 60);
  const std::vector<int8_t>& loadings = components.loadings[0];
  const int first = loadings[0] > 0 ? 1 : -1;
  for (size_t i = 0; i < 60; ++i) {
    INFO(i);
    CHECK(first * loadings[i] * (i % 2 == 0 ? 1 : -1) > 100);
  }
  // The places are about 570 bits farther apart than their own frames, half of it on either side of
  // the mean. With w close to the sum of all eigenvalues, at most 60 / (60 + 15) of it is
  // subtracted, and slightly less because of the frames' own bits.
  ComponentValues strongest = {};
  strongest[0] = make_projector(components)(train.rows[0])[0];
  const ComponentWeights weights = component_weights(components, strongest);
  const double unit = component_unit(train.rows.shape);
  CHECK(unit * component_sum(components, weights, 1) == Approx(285 * 60.0 / 75).epsilon(0.05));
  CHECK(unit * component_sum(components, weights, 0) == Approx(-285 * 60.0 / 75).epsilon(0.05));
}

TEST_CASE("components are orthogonal unit vectors, the strongest first") {
  const test::Example example = test::make_example({300, 5, 400}, 1, 8);
  const TrainComponents components = compute_components(example.spans(), 0, {});
  CHECK(components.landmarks.size() == kMostLandmarks);
  CHECK(std::is_sorted(components.landmarks.begin(), components.landmarks.end()));
  CHECK(components.landmarks.front() == 0);
  CHECK(components.landmarks.back() < 705);
  for (size_t j = 0; j < kMaxComponents; ++j)
    for (size_t k = 0; k < kMaxComponents; ++k)
      CHECK(shared(components, j, k) == Approx(j == k ? 1 : 0).margin(1e-4));
  for (const ComponentValues& weights : components.weights)
    for (const double weight : weights)
      REQUIRE(weight * (1 << 20) == std::floor(weight * (1 << 20)));
}

TEST_CASE("the first component explains as much as the best of a thousand iterations") {
  const test::Example example = test::make_example({150}, 1, 4);
  const TrainComponents components = compute_components(example.spans(), 0, {});
  const DescriptorRows rows = components.rows();
  const size_t n = rows.size();
  const std::vector<double> distances = distances_within(rows);
  // Power iteration on -1/2 (distances, minus row and column means, plus the mean).
  const auto similarity_times = [&](const std::vector<double>& vector) {
    double mean = 0;
    for (const double value : vector) mean += value / static_cast<double>(n);
    std::vector<double> product(n, 0);
    double sum = 0;
    for (size_t a = 0; a < n; ++a) {
      for (size_t b = 0; b < n; ++b) product[a] -= distances[a * n + b] * (vector[b] - mean) / 2;
      sum += product[a];
    }
    for (double& value : product) value -= sum / static_cast<double>(n);
    return product;
  };
  const auto norm = [](const std::vector<double>& vector) {
    double sum = 0;
    for (const double value : vector) sum += value * value;
    return std::sqrt(sum);
  };
  std::vector<double> best(n);
  for (size_t a = 0; a < n; ++a) best[a] = std::cos(static_cast<double>(a));
  for (int i = 0; i < 1000; ++i) {
    best = similarity_times(best);
    const double length = norm(best);
    for (double& value : best) value /= length;
  }
  std::vector<double> found;
  for (const ComponentValues& weights : components.weights) found.push_back(weights[0]);
  CHECK(norm(similarity_times(found)) == Approx(norm(similarity_times(best))).epsilon(0.02));
}

TEST_CASE("loadings of landmarks are proportional to their weights") {
  const test::Example example = test::make_example({90, 30}, 1, 5);
  const TrainComponents components = compute_components(example.spans(), 0, {});
  REQUIRE(components.landmarks.size() == 120);
  double largest = 0;
  for (const ComponentValues& weights : components.weights)
    largest = std::max(largest, std::abs(weights[0]));
  // Variance that a few iterations miss in the first component is in the next ones.
  for (size_t l = 0; l < 120; ++l)
    CHECK(components.loadings[0][l] == Approx(127 * components.weights[l][0] / largest).margin(12));
}

TEST_CASE("sums by tables equal sums of direct distances") {
  const test::Example example = test::make_example({40}, 20, 6);
  const TrainComponents components = compute_components(example.spans(), 0, {});
  const Projector project = make_projector(components);
  for (const LdbCode& code : example.query)
    CHECK(project(code) == reference_components(components, code));
}

TEST_CASE("sums by tables for vectors equal sums of unrounded distances") {
  RandomEngine engine(9);
  std::vector<uint8_t> bytes(50 * 24);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(uniform_below(engine, 256));
  std::fill_n(bytes.begin() + 7 * 24, 24, uint8_t{0});  // no direction
  const DescriptorRows rows({ElementType::int8, 24}, bytes);
  const DescribedFrames train{rows, {}};
  const TrainComponents components = compute_components({&train, 1}, 0, {});
  const Projector project = make_projector(components);
  for (size_t i = 0; i < rows.size(); ++i) {
    const ComponentValues found = project(rows[i]);
    const ComponentValues expected = reference_components(components, rows[i]);
    for (size_t k = 0; k < kMaxComponents; ++k) CHECK(found[k] == Approx(expected[k]).margin(1e-6));
  }
}

TEST_CASE("components are the same for any number of threads") {
  const test::Example example = test::make_example({900, 5000}, 1, 7);
  const TrainComponents expected = compute_components(example.spans(), 0, {});
  for (const size_t threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const TrainComponents found = compute_components(example.spans(), 0, {});
    CHECK(found.weights == expected.weights);
    CHECK(found.factor == expected.factor);
    CHECK(found.loadings == expected.loadings);
  }
}

TEST_CASE("equal frames, a single frame and no frames have no component") {
  for (const size_t count : {0, 1, 30}) {
    const std::vector<LdbCode> codes(count, LdbCode{});
    const DescribedFrames train{codes, {}};
    const TrainComponents components = compute_components({&train, 1}, 0, {});
    CHECK(components.factor == ComponentValues{});
    for (const std::vector<int8_t>& loadings : components.loadings)
      CHECK(loadings == std::vector<int8_t>(count, 0));
  }
}

TEST_CASE("a stop in training adds no landmarks") {
  const test::Example example = test::make_example({60}, 1, 5);
  std::vector<LdbCode> slow;
  for (size_t i = 0; i < 60; ++i)
    for (size_t n = 0; n < (i == 20 ? 50 : 2); ++n) slow.push_back(example.train[0][i]);
  const DescribedFrames walk{example.train[0], {}};
  const DescribedFrames slow_walk{slow, {}};
  const TrainComponents once = compute_components({&walk, 1}, 300, {});
  const TrainComponents often = compute_components({&slow_walk, 1}, 300, {});
  CHECK(once.landmarks.size() > 20);
  CHECK(often.bytes == once.bytes);
  CHECK(often.factor == once.factor);
}

TEST_CASE("unreadable frames are not landmarks") {
  test::Example example = test::make_example({20, 4}, 1, 2);
  example.train_unreadable = {{0, 5}, {3}};
  const TrainComponents components = compute_components(example.spans(), 0, {});
  CHECK(components.landmarks.size() == 21);
  for (const size_t frame : {0, 5, 23})
    CHECK(std::count(components.landmarks.begin(), components.landmarks.end(), frame) == 0);
}

TEST_CASE("products of loadings and weights are rounded to nearest, ties up") {
  CHECK(component_product(127, 4095) == 4063);
  CHECK(component_product(-127, 4095) == -4063);
  CHECK(component_product(1, 64) == 1);
  CHECK(component_product(1, 63) == 0);
  CHECK(component_product(-1, 64) == 0);
  CHECK(component_product(-1, 65) == -1);
  CHECK(component_product(64, -3) == -1);  // -1.5
}
