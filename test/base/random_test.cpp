#include "base/random.h"

#include <catch2/catch.hpp>

using namespace vpr;

TEST_CASE("random numbers are those of the standard's engine, on every machine") {
  RandomEngine engine;  // the standard states the 10000th value of a default one
  engine.discard(9999);
  CHECK(engine() == 9981545732273789042ULL);
}

TEST_CASE("uniform numbers stay below their bound and reach every value") {
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
