#include <limits>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "decide/score_kind.h"

using namespace vpr;

TEST_CASE("the limit is the smallest distance whose quotient is not below the threshold") {
  CHECK(distance_limit(0.4, 1000) == 400);  // 400 / 1000 < 0.4 is false
  CHECK(distance_limit(0.4, 1001) == 401);  // 400.4
  CHECK(distance_limit(1.0, 7) == 7);
  CHECK(distance_limit(0, 7) == 0);
  CHECK(distance_limit(-1, 7) == 0);
  CHECK(distance_limit(1e-300, 7) == 1);
}

TEST_CASE("with a divisor of zero, the quotient counts as zero") {
  CHECK(distance_limit(0.5, 0) == 1);
  CHECK(distance_limit(0, 0) == 0);
}

TEST_CASE("thresholds above every distance make every cell a recognition") {
  CHECK(distance_limit(1e300, 5) == std::numeric_limits<uint32_t>::max());
}

TEST_CASE("the limit equals the division, cell by cell") {
  RandomEngine engine(1);
  for (int i = 0; i < 2000; ++i) {
    const auto divisor = static_cast<uint32_t>(1 + uniform_below(engine, 70'000));
    const double threshold = uniform_unit(engine);
    const uint32_t limit = distance_limit(threshold, divisor);
    for (uint32_t d = limit < 3 ? 0 : limit - 3; d < limit + 3; ++d)
      REQUIRE((d < limit) == (static_cast<double>(d) / divisor < threshold));
  }
  // Exact quotients: multiplication instead of division would round differently.
  for (uint32_t divisor = 1; divisor < 300; ++divisor)
    for (uint32_t d = 0; d <= divisor; ++d)
      REQUIRE(distance_limit(static_cast<double>(d) / divisor, divisor) == d);
}

TEST_CASE("the limit of a mean z equals the division, also for negative thresholds") {
  CHECK(score_limit(0, 3) == 3 * 32768);
  CHECK(score_limit(-1, 1) == 32768 - 1024);
  CHECK(score_limit(-1.5, 10) == 10 * 32768 - 15360);  // -1.5 itself is not a recognition
  CHECK(score_limit(-32, 4) == 0);
  CHECK(score_limit(-1e300, 4) == 0);
  CHECK(score_limit(1e300, 4) == std::numeric_limits<uint32_t>::max());
  CHECK(mean_z(32768 - 1024, 1) == -1.0);
  RandomEngine engine(1);
  for (int i = 0; i < 2000; ++i) {
    const size_t length = 1 + uniform_below(engine, kMaxScoredWindow);
    const double threshold = 8 * uniform_unit(engine) - 6;
    const uint32_t limit = score_limit(threshold, length);
    for (uint32_t sum = limit - 3; sum < limit + 3; ++sum)
      REQUIRE((sum < limit) == (mean_z(sum, length) < threshold));
  }
}
