// Random numbers, statistics and checksums.
#include "base/statistics.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/checksum.h"
#include "base/random.h"

using namespace vpr;

TEST_CASE("random numbers equal those of the standard's engine") {
  RandomEngine engine;  // the standard specifies the 10000th value of a default engine
  engine.discard(9999);
  CHECK(engine() == 9981545732273789042ULL);
}

TEST_CASE("uniform numbers are below their bound and include every value") {
  RandomEngine engine(1);
  std::vector<int> seen(7, 0);
  for (int i = 0; i < 7000; ++i) ++seen.at(uniform_below(engine, 7));
  for (const int count : seen) CHECK(std::abs(count - 1000) < 150);
  CHECK(uniform_below(engine, 1) == 0);
  for (int i = 0; i < 1000; ++i) {
    const double u = uniform_unit(engine);
    REQUIRE((u >= 0 && u < 1));
  }
}

TEST_CASE("the median is the middle value or the mean of the two middle ones") {
  CHECK(median({3}) == 3);
  CHECK(median({5, 1, 3}) == 3);
  CHECK(median({4, 1, 3, 2}) == 2.5);
  CHECK(median({1, 1, 1, 9}) == 1);
}

TEST_CASE("quantiles equal NumPy's") {
  const std::vector<double> values = {15, 20, 35, 40, 50};
  CHECK(quantile(values, 0) == 15);
  CHECK(quantile(values, 1) == 50);
  CHECK(quantile(values, 0.25) == 20);
  CHECK(quantile(values, 0.4) == Approx(29));  // 20 + 0.6 * (35 - 20)
}

TEST_CASE("the bootstrap of a sum equals its closed forms") {
  // Equal values: every resample has the same sum.
  const Interval same = bootstrap_sum(std::vector<double>(50, 2), 7, 1);
  CHECK(same.low == 100);
  CHECK(same.high == 100);
  // One block as long as the whole sequence: every resample is a rotation.
  std::vector<double> values;
  for (int i = 0; i < 40; ++i) values.push_back(i % 3);
  const Interval rotated = bootstrap_sum(values, 40, 1);
  CHECK(rotated.low == Approx(39));
  CHECK(rotated.high == Approx(39));
  // Independent values of variance 1/4, block 1: the sum of n is normal, +- 1.96 sqrt(n) / 2.
  std::vector<double> coins;
  for (int i = 0; i < 400; ++i) coins.push_back(i % 2);
  const Interval coin = bootstrap_sum(coins, 1, 3);
  CHECK(coin.low == Approx(200 - 19.6).margin(3));
  CHECK(coin.high == Approx(200 + 19.6).margin(3));
  // The same values in runs of 20: blocks of 20 detect their dependence.
  std::sort(coins.begin(), coins.end());
  std::vector<double> stretches;
  for (int i = 0; i < 400; ++i) stretches.push_back(i / 20 % 2);
  const Interval wide = bootstrap_sum(stretches, 20, 3);
  CHECK(wide.high - wide.low > 2 * (coin.high - coin.low));
  CHECK(bootstrap_sum(stretches, 20, 3).low == wide.low);
}

TEST_CASE("checksums equal XXH3's 128-bit values") {
  CHECK(checksum("") == "xxh3:99aa06d3014798d86001c324468d497f");  // published test vector
  CHECK(checksum("a") != checksum("b"));
}

TEST_CASE("a stream's checksum does not depend on how the bytes are split") {
  const std::string text(1000, 'x');
  ChecksumStream stream;
  stream.add(std::as_bytes(std::span(text).first(1)));
  stream.add(std::as_bytes(std::span(text).subspan(1, 700)));
  stream.add({});
  stream.add(std::as_bytes(std::span(text).subspan(701)));
  CHECK(stream.text() == checksum(text));
}
