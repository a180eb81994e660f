#include "base/statistics.h"

#include <catch2/catch.hpp>

using namespace vpr;

TEST_CASE("the median is the middle value or the mean of the two middle ones") {
  CHECK(median({3}) == 3);
  CHECK(median({5, 1, 3}) == 3);
  CHECK(median({4, 1, 3, 2}) == 2.5);
  CHECK(median({1, 1, 1, 9}) == 1);
}

TEST_CASE("quantiles are NumPy's") {
  const std::vector<double> values = {15, 20, 35, 40, 50};
  CHECK(quantile(values, 0) == 15);
  CHECK(quantile(values, 1) == 50);
  CHECK(quantile(values, 0.25) == 20);
  CHECK(quantile(values, 0.4) == Approx(29));  // 20 + 0.6 * (35 - 20)
}
