#include "base/running_quantile.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace vpr;

TEST_CASE("the running median of five values is the third, second of four, first of two") {
  RunningQuantile median(0.5);
  CHECK(median.is_empty());
  std::vector<double> seen;
  for (const double value : {5.0, 1.0, 4.0, 2.0, 3.0}) {
    median.add(value);
    seen.push_back(median.value());
  }
  CHECK(seen == std::vector<double>{5, 1, 4, 2, 3});
}

TEST_CASE("running quantiles are those of the sorted values, with ties") {
  RandomEngine engine(7);
  for (const double share : {0.0, 0.07, 0.5, 0.93, 1.0}) {
    RunningQuantile running(share);
    std::vector<double> sorted;
    for (int i = 0; i < 300; ++i) {
      const auto value = static_cast<double>(uniform_below(engine, 40));
      running.add(value);
      sorted.insert(std::upper_bound(sorted.begin(), sorted.end(), value), value);
      const auto index = static_cast<size_t>(std::floor(share * double(sorted.size() - 1)));
      REQUIRE(running.value() == sorted[index]);
    }
  }
}
