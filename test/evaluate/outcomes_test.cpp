#include "evaluate/outcomes.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "evaluate/judgment.h"
#include "support.h"

using namespace vpr;

namespace {

// Ten query frames and twelve training frames, c_l 3.
Result random_result(RandomEngine& engine) {
  Result result;
  SequenceQuerySettings settings;
  settings.window_length = 3;
  result.settings = settings;
  result.query.frames = 10;
  result.query_windows = 8;
  result.targets = {{{"ref", 12}, 10, true, 0.5, ThresholdScale::relative, 10, 100}};
  for (uint32_t window = 0; window < 8; ++window) {
    const bool found = uniform_below(engine, 5) != 0;
    result.best.push_back(found
                              ? std::optional(Match{window, 0, uint32_t(uniform_below(engine, 10)),
                                                    0, double(uniform_below(engine, 50))})
                              : std::nullopt);
    if (!found && uniform_below(engine, 2) == 0) result.query.unreadable = {window};
  }
  return result;
}

GroundTruth random_truth(RandomEngine& engine) {
  GroundTruth truth;
  truth.pairs.resize(10);
  for (auto& pairs : truth.pairs)
    for (uint64_t i = uniform_below(engine, 4); i > 0; --i)
      pairs.push_back({0, uint32_t(uniform_below(engine, 12)),
                       uniform_below(engine, 3) == 0 ? PlaceLabel::ignore : PlaceLabel::same});
  return truth;
}

}  // namespace

TEST_CASE("outcomes count best matches as reports do") {
  RandomEngine engine(2);
  for (int round = 0; round < 300; ++round) {
    const Result result = random_result(engine);
    const GroundTruth truth = random_truth(engine);
    const BestMatchCounts expected = count_recognitions(result, truth).best_match;
    const Outcomes outcomes = outcomes_of(result, truth);
    const BestMatchCounts found = best_match_counts(outcomes);
    REQUIRE(found.queries == expected.queries);
    REQUIRE(found.correct == expected.correct);
    REQUIRE(found.ignored == expected.ignored);
    REQUIRE(found.without_match == expected.without_match);
    REQUIRE(found.unreadable == expected.unreadable);
    REQUIRE(recall_at(outcomes, 1) == expected.rate());
    REQUIRE(judged_queries(outcomes) == expected.queries - expected.ignored);
  }
}

TEST_CASE("best matches have no ranks after the first") {
  RandomEngine engine(2);
  CHECK_FALSE(recall_at(outcomes_of(random_result(engine), random_truth(engine)), 5));
}

TEST_CASE("a probability is a similarity, and a frame without words is incorrect") {
  Result result;
  result.settings = FabmapQuerySettings{};
  result.query.frames = result.query_windows = 3;
  result.places = ResultPlaces{{"a", "b"}, 2, 0, {}};
  result.targets.resize(1);
  result.targets[0].sequence.frames = 2;
  result.best = {Match{0, 0, 0, 0, 0.4}, std::nullopt, Match{2, 0, 1, 1, 0.9}};
  GroundTruth truth;
  truth.pairs = {
      {{0, 0, PlaceLabel::same}}, {{0, 1, PlaceLabel::same}}, {{0, 0, PlaceLabel::same}}};
  const Outcomes outcomes = outcomes_of(result, truth);
  CHECK(outcomes.queries[0].verdict == Verdict::correct);
  CHECK(outcomes.queries[1].verdict == Verdict::incorrect);
  CHECK(outcomes.queries[2].verdict == Verdict::incorrect);
  const Curve curve = single_best_curve(outcomes);
  CHECK(curve.to_find == 3);
  REQUIRE(curve.points.size() == 2);
  CHECK(curve.threshold(curve.points[0]) == 0.9);
  CHECK(curve.points[1].correct == 1);
}

TEST_CASE("matches can be accepted by margin, and those without one never are") {
  Result result;
  SequenceQuerySettings settings;
  settings.window_length = 2;
  result.settings = settings;
  result.query.frames = 5;
  result.query_windows = 4;
  result.targets = {{{"ref", 9}, 8, true, 0.5, ThresholdScale::relative, 10, 100}};
  result.best = {Match{0, 0, 0, 0, 40}, Match{1, 0, 1, 0, 10}, Match{2, 0, 7, 0, 5},
                 Match{3, 0, 3, 0, 50}};
  result.margins = {30, 20, 4, std::nullopt};  // sums over two frames
  result.targets[0].margin = 12;
  GroundTruth truth;
  for (uint32_t frame = 0; frame < 5; ++frame)
    truth.pairs.push_back({{0, frame, PlaceLabel::same}});
  Outcomes outcomes = outcomes_of(result, truth);
  CHECK(outcomes.has_margins);
  CHECK(outcomes.confidence == Confidence::score);
  CHECK(outcomes.queries[0].margin == 15);
  CHECK(outcomes.queries[0].asked_margin == 12);
  CHECK_FALSE(outcomes.queries[3].margin);
  CHECK(single_best_curve(outcomes).points.front().incorrect == 1);
  // a result with a decision by margin is evaluated by margin
  settings.decision = Decision::margin;
  result.settings = settings;
  outcomes = outcomes_of(result, truth);
  CHECK(outcomes.confidence == Confidence::margin);
  CHECK(judge(result, truth, {}).single_best == single_best_curve(outcomes));
  const Curve curve = single_best_curve(outcomes);
  CHECK(curve.kind == ScoreOrder::similarity);
  CHECK(curve.to_find == 4);
  REQUIRE(curve.points.size() == 3);
  CHECK(curve.threshold(curve.points[0]) == 15);
  CHECK(curve.threshold(curve.points[1]) == 10);
  CHECK(curve.points[1].correct == 2);
  CHECK(curve.points[1].incorrect == 0);
  CHECK(curve.points[2].correct == 2);
  CHECK(curve.points[2].incorrect == 1);
}

TEST_CASE("evaluations can be ordered by either confidence, and by margin only if there are any") {
  RandomEngine engine(4);
  Result result = random_result(engine);
  const GroundTruth truth = random_truth(engine);
  Judgment without = judge(result, truth, {});
  CHECK_FALSE(without.other_best);
  CHECK(test::error_kind([&] { order_by(without, Confidence::margin); }) == ErrorKind::usage);
  for (size_t window = 0; window < result.best.size(); ++window)
    result.margins.push_back(result.best[window] ? std::optional<double>(3 * window)
                                                 : std::nullopt);
  Judgment judgment = judge(result, truth, {});
  CHECK(judgment.single_best == without.single_best);
  REQUIRE(judgment.other_best);
  const Curve by_margin = *judgment.other_best;
  order_by(judgment, Confidence::margin);
  CHECK(judgment.single_best == by_margin);
  CHECK(judgment.other_best == without.single_best);
}
