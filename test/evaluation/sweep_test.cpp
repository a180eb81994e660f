#include "evaluation/sweep.h"

#include <catch2/catch.hpp>

using namespace vpr;

TEST_CASE(
    "the recommendation has most places and no error; ties by hits, then window, then order") {
  // distinct, incorrect, hits, window, threshold
  const std::vector<SweepScore> scores = {
      {3, 1, 90, 10, 0.5}, {2, 0, 50, 20, 0.4}, {2, 0, 60, 40, 0.4}, {2, 0, 60, 20, 0.5},
      {2, 0, 60, 20, 0.6}, {1, 0, 99, 5, 0.3},  {4, 9, 99, 20, 0.9}, {2, 3, 70, 20, 0.7}};
  const Recommendation choice = recommend(scores);
  CHECK(choice.cell == 3);
  CHECK(choice.nearest_error == 7);  // the same window, 0.2 away; 0.9 is 0.4 away
  CHECK(choice.pareto == std::vector<size_t>{0, 1, 2, 3, 4, 6});
}

TEST_CASE("without a setting that has no error, none is recommended") {
  CHECK(!recommend({}).cell);
  const Recommendation wrong = recommend(std::vector<SweepScore>{{5, 1, 9, 1, 0.1}});
  CHECK(!wrong.cell);
  CHECK(wrong.reason.find("incorrect") != std::string::npos);
  const Recommendation nothing = recommend(std::vector<SweepScore>{{0, 0, 0, 1, 0.1}});
  CHECK(!nothing.cell);
  CHECK(nothing.reason.find("no setting recognises") != std::string::npos);
}
