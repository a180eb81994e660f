#include "recognition/running_share.h"

#include <catch2/catch.hpp>

using namespace vpr;

namespace {

// Best scores 10, 20, 30, 40; elsewhere 15, none, 32, 50.
Result example() {
  Result result;
  result.query_windows = 4;
  for (uint32_t window = 0; window < 4; ++window)
    result.best.push_back(Match{window, 0, 7, 0, 10.0 + 10 * window});
  result.margins = {5, std::nullopt, 2, 10};
  for (uint32_t window = 0; window < 4; ++window)
    for (const double score : {14.0, 15.0, 31.0, 32.0, 49.0})
      result.hits.push_back({window, 0, 1, 0, score});
  return result;
}

std::vector<double> scores_of(const Result& result, uint32_t window) {
  std::vector<double> scores;
  for (const Match& hit : result.hits)
    if (hit.query == window) scores.push_back(hit.score);
  return scores;
}

}  // namespace

TEST_CASE("with share 0 hits are closer than anything elsewhere so far") {
  Result result = example();
  limit_by_share(result, 0);
  for (uint32_t window = 0; window < 4; ++window)
    CHECK(scores_of(result, window) == std::vector<double>{14});
}

TEST_CASE("the share counts the windows up to the hit's own one, and no later ones") {
  Result result = example();
  limit_by_share(result, 1);  // the largest so far
  CHECK(scores_of(result, 0) == std::vector<double>{14});
  CHECK(scores_of(result, 1) == std::vector<double>{14});
  CHECK(scores_of(result, 2) == std::vector<double>{14, 15, 31});
  CHECK(scores_of(result, 3) == std::vector<double>{14, 15, 31, 32, 49});
  result = example();
  limit_by_share(result, 0.5);  // of two the first, of three the second
  CHECK(scores_of(result, 2) == std::vector<double>{14});
  CHECK(scores_of(result, 3) == std::vector<double>{14, 15, 31});
}

TEST_CASE("hits in front of the first window with something elsewhere stay") {
  Result result = example();
  result.margins[0].reset();
  limit_by_share(result, 0);
  CHECK(scores_of(result, 0).size() == 5);
  CHECK(scores_of(result, 1).size() == 5);
  CHECK(scores_of(result, 2) == std::vector<double>{14, 15, 31});
}
