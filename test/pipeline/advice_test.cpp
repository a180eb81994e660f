// What is said where a threshold recognises nothing, or everything.
#include "pipeline/advice.h"

#include <catch2/catch.hpp>

using namespace vpr;

namespace {

// Twenty query windows against ten training windows; the best match of window j is at 100 + 10 j.
Result planned_result(ThresholdScale scale, double threshold) {
  Result result;
  SequenceQuerySettings settings;
  settings.window_length = 2;
  settings.distance_threshold = threshold;
  result.settings = settings;
  result.query_windows = 20;
  Target& sequence = result.targets.emplace_back();
  sequence.name = "walk";
  sequence.windows = 10;
  sequence.threshold = threshold;
  sequence.scale = scale;
  if (scale == ThresholdScale::relative) sequence.max_distance = 1000;
  for (uint32_t j = 0; j < 20; ++j) result.best.emplace_back(Match{j, 0, 3, 0, 100 + 10.0 * j});
  return result;
}

}  // namespace

TEST_CASE("on the scale mean the closest is the one that is closest for its window") {
  Result result = planned_result(ThresholdScale::mean, 0.1);
  result.targets[0].window_means.assign(20, 400);
  result.targets[0].window_means[5] = 1000;  // 150 of 1000
  const auto advice = threshold_advice(result);
  REQUIRE(advice);
  CHECK(advice->sentence.find("0.150 of what this window differs by on average") !=
        std::string::npos);
  REQUIRE(advice->suggested);
  CHECK(advice->suggested->scale == ThresholdScale::mean);
  CHECK(advice->suggested->threshold == Approx(0.251));  // the second is 100 of 400
  CHECK(advice->suggested->windows == 2);
}

TEST_CASE("without a hit, the closest windows and a threshold for a tenth of them are said") {
  const auto bits = threshold_advice(planned_result(ThresholdScale::bits, 10));
  REQUIRE(bits);
  CHECK_FALSE(bits->is_too_large);
  CHECK(bits->sentence.find("query frame 1 and walk frame 4: mean frame distance 50.0") !=
        std::string::npos);
  REQUIRE(bits->suggested);
  CHECK(bits->suggested->threshold == 55.1);  // the second closest has 110 / 2
  CHECK(bits->suggested->scale == ThresholdScale::bits);
  CHECK(bits->suggested->windows == 2);
  const auto relative = threshold_advice(planned_result(ThresholdScale::relative, 0.05));
  REQUIRE(relative);
  CHECK(relative->sentence.find("0.100 of the largest distance, mean frame distance 50.0") !=
        std::string::npos);
  REQUIRE(relative->suggested);
  CHECK(relative->suggested->threshold == Approx(0.111));
  CHECK(relative->suggested->windows == 2);
}

TEST_CASE("more than a fifth of all pairs as hits is too much") {
  Result result = planned_result(ThresholdScale::bits, 200);
  for (uint32_t j = 0; j < 20; ++j)
    for (uint32_t i = 0; i < 2; ++i) result.hits.push_back({j, 0, i, 0, 300});
  CHECK_FALSE(threshold_advice(result));  // 40 of 200
  result.hits.push_back({19, 0, 2, 0, 300});
  const auto advice = threshold_advice(result);
  REQUIRE(advice);
  CHECK(advice->is_too_large);
  CHECK(advice->sentence.find("20 % of all window pairs are hits") == 0);
  REQUIRE(advice->suggested);
  CHECK(advice->suggested->threshold == 55.1);
  result.targets[0].threshold = 55;
  CHECK_FALSE(threshold_advice(result)->suggested);  // no help
  CHECK(recognised_windows(result) == 20);
}

TEST_CASE("mean z is suggested below 0 or not at all") {
  Result result = planned_result(ThresholdScale::mean_z, -9);
  std::get<SequenceQuerySettings>(result.settings).score = Score::standardized;
  for (auto& match : result.best) match->score = -2 * 1024;
  const auto advice = threshold_advice(result);
  REQUIRE(advice);
  CHECK(advice->sentence.find("mean z -1.00") != std::string::npos);
  REQUIRE(advice->suggested);
  CHECK(advice->suggested->threshold == -0.99);
  CHECK(advice->suggested->windows == 20);
  for (auto& match : result.best) match->score = 2 * 1024;
  CHECK_FALSE(threshold_advice(result)->suggested);
  result.best.assign(20, std::nullopt);
  CHECK_FALSE(threshold_advice(result));
}
