#include <catch2/catch.hpp>

#include "decide/clustering.h"

using namespace vpr;

TEST_CASE("a place is one run while it is recognized in consecutive frames") {
  const std::vector<Match> recognitions = {{3, 0, 1, 0, 0.5}, {4, 0, 0, 0, 0.6}, {4, 0, 1, 0, 0.9},
                                           {5, 0, 1, 0, 0.7}, {6, 0, 0, 0, 0.8}, {7, 0, 1, 0, 0.4}};
  CHECK(place_runs(recognitions, 1, 0) == std::vector<PlaceRun>{{3, 5, 1, 1, 3, 0.9},
                                                                {4, 4, 0, 0, 1, 0.6},
                                                                {6, 6, 0, 0, 1, 0.8},
                                                                {7, 7, 1, 1, 1, 0.4}});
  CHECK(place_runs({}, 1, 0).empty());
}

TEST_CASE("if each frame is a place, a run is a range of consecutive places") {
  const std::vector<Match> recognitions = {{0, 0, 11, 0, 0.5}, {1, 0, 12, 0, 0.6},
                                           {2, 0, 36, 0, 0.7}, {3, 0, 12, 0, 0.7},
                                           {4, 0, 14, 0, 0.8}, {8, 0, 15, 0, 0.9}};
  CHECK(place_runs(recognitions, 2, 2) == std::vector<PlaceRun>{{0, 4, 11, 14, 4, 0.8},
                                                                {2, 2, 36, 36, 1, 0.7},
                                                                {8, 8, 15, 15, 1, 0.9}});
}
