#include <catch2/catch.hpp>

#include "match/zscore_model.h"
#include "support.h"

using namespace vpr;

TEST_CASE("a stop is one keyframe, and so is a frame similar to one of the last five") {
  // Random codes differ in about 693 of 1386 bits; a few changed bits are the same view.
  const std::vector<LdbCode> places = test::random_codes(9, 1);
  std::vector<LdbCode> walk = {places[0], places[0], places[1], places[1], places[1], places[2],
                               places[0], places[3], places[4], places[5], places[6], places[0]};
  walk[3][0] ^= 7;
  const double typical = 400;
  CHECK(view_starts({walk, {}}, typical) == std::vector<uint32_t>{0, 2, 5, 7, 8, 9, 10, 11});
  const std::vector<size_t> unreadable = {0, 5, 10};
  CHECK(view_starts({walk, unreadable}, typical) == std::vector<uint32_t>{0, 1, 2, 7, 8, 9});
  CHECK(view_starts({}, typical).empty());
  CHECK(view_starts({std::span<const LdbCode>(walk).first(1), {}}, typical) ==
        std::vector<uint32_t>{0});
}

TEST_CASE("a frame is a new keyframe from a quarter of the typical distance on, inclusive") {
  std::vector<LdbCode> walk = {LdbCode{}, LdbCode{}};
  for (size_t b = 0; b < 12; ++b) walk[1][b] = 0xff;  // 96 bits
  CHECK(view_starts({walk, {}}, 384).size() == 2);
  CHECK(view_starts({walk, {}}, 384.1).size() == 1);
}
