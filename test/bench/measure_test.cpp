#include "bench/measure.h"

#include <atomic>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "bench/generated.h"
#include "matching/plain.h"
#include "support.h"

using namespace vpr;

TEST_CASE("a summary has the closed forms of evenly spaced values") {
  // 1, 2, ..., n: the p-quantile is 1 + p (n - 1).
  for (const size_t n : {1, 2, 5, 100, 101}) {
    std::vector<double> values;
    for (size_t i = n; i > 0; --i) values.push_back(static_cast<double>(i));
    const TimeSummary summary = summarise(values);
    const auto last = static_cast<double>(n);
    CHECK(summary.median_ms == Approx(1 + 0.5 * (last - 1)));
    CHECK(summary.lower_quartile_ms == Approx(1 + 0.25 * (last - 1)));
    CHECK(summary.upper_quartile_ms == Approx(1 + 0.75 * (last - 1)));
    CHECK(summary.least_ms == 1);
    CHECK(summary.most_ms == last);
    CHECK(summary.repetitions == n);
  }
}

TEST_CASE("work is repeated often enough, long enough, and no more than that") {
  size_t runs = 0;
  const auto count = [&] { ++runs; };
  CHECK(time_repeatedly({0, 7, 100, 2}, count, {}).size() == 7);
  CHECK(runs == 9);
  CHECK(time_repeatedly({1000, 1, 12, 0}, count, {}).size() == 12);
}

TEST_CASE("a stop ends a measurement") {
  const std::atomic<bool> stop = true;
  Monitor monitor;
  monitor.stop = &stop;
  CHECK(test::error_kind([&] {
          time_repeatedly(
              {}, [] {}, monitor);
        }) == ErrorKind::interrupted);
}

TEST_CASE("generated walks change little from frame to frame, and more on another day") {
  const auto walk = generate_walk(200, 1);
  CHECK(walk == generate_walk(200, 1));
  CHECK(walk != generate_walk(200, 2));
  const auto again = walk_again(walk, 50, 100, 150, 3);
  for (size_t i = 0; i + 1 < 100; ++i) {
    CHECK(plain_hamming(walk[i], walk[i + 1]) > 20);
    CHECK(plain_hamming(walk[i], walk[i + 1]) <= 60);
    CHECK(plain_hamming(walk[50 + i], again[i]) > 80);
    CHECK(plain_hamming(walk[50 + i], again[i]) <= 150);
  }
  CHECK(plain_hamming(walk[0], walk[199]) > 500);
}
