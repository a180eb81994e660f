#include "evaluate/outcomes.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "evaluate/judgment.h"
#include "queries.h"
#include "support.h"

using namespace vpr;

namespace {

// Ten query frames and twelve training frames, c_l 3.
Result random_result(RandomEngine& engine) {
  Result result = test::make_result(10, 3, 12);
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

TEST_CASE("recall@1 is the rate of best matches") {
  RandomEngine engine(2);
  for (int round = 0; round < 300; ++round) {
    const Result result = random_result(engine);
    const Outcomes outcomes = outcomes_of(result, random_truth(engine));
    const BestMatchCounts counts = best_match_counts(outcomes);
    REQUIRE(recall_at(outcomes, 1) == counts.rate());
    REQUIRE(frames_with_match(outcomes) == counts.frames);
    REQUIRE(counts.frames == counts.correct + counts.incorrect + counts.ignored + counts.no_answer);
  }
}

TEST_CASE("best matches have no ranks after the first") {
  RandomEngine engine(2);
  CHECK_FALSE(recall_at(outcomes_of(random_result(engine), random_truth(engine)), 5));
}

TEST_CASE("a probability is a similarity, and a frame without words is not recognized") {
  Result result;
  result.settings = FabmapQuerySettings{};
  result.query.frames = result.query_windows = 3;
  result.places = ResultPlaces{{"a", "b"}, 2, 0, {}};
  result.sequences.resize(1);
  result.sequences[0].sequence.frames = 2;
  result.best = {Match{0, 0, 0, 0, 0.4}, std::nullopt, Match{2, 0, 1, 1, 0.9}};
  GroundTruth truth;
  truth.pairs = {
      {{0, 0, PlaceLabel::same}}, {{0, 1, PlaceLabel::same}}, {{0, 0, PlaceLabel::same}}};
  const Outcomes outcomes = outcomes_of(result, truth);
  CHECK(outcomes.queries[0].verdict == Verdict::correct);
  CHECK(outcomes.queries[1].verdict == Verdict::none);
  CHECK(outcomes.queries[2].verdict == Verdict::incorrect);
  const Curve curve = single_best_curve(outcomes);
  CHECK(curve.positives == 3);
  REQUIRE(curve.points.size() == 2);
  CHECK(curve.threshold(curve.points[0]) == 0.9);
  CHECK(curve.points[1].correct == 1);
}

TEST_CASE("matches can be accepted by margin, and those without one never are") {
  Result result = test::make_result(5, 2, 9);
  result.best = {Match{0, 0, 0, 0, 40}, Match{1, 0, 1, 0, 10}, Match{2, 0, 7, 0, 5},
                 Match{3, 0, 3, 0, 50}};
  result.margins = {30, 20, 4, std::nullopt};  // sums over two frames
  result.sequences[0].margin = 12;
  const GroundTruth truth = test::aligned_truth(5, 5);
  Outcomes outcomes = outcomes_of(result, truth);
  CHECK(outcomes.has_margins);
  CHECK(outcomes.confidence == Confidence::score);
  CHECK(outcomes.queries[1].margin == 15);
  CHECK(outcomes.queries[1].required_margin == 12);
  CHECK_FALSE(outcomes.queries[4].margin);
  CHECK(single_best_curve(outcomes).points.front().incorrect == 1);
  // a result with a decision by margin is evaluated by margin
  result.settings = test::by_margin(2);
  outcomes = outcomes_of(result, truth);
  CHECK(outcomes.confidence == Confidence::margin);
  CHECK(judge(result, truth, {}).single_best == single_best_curve(outcomes));
  const Curve curve = single_best_curve(outcomes);
  CHECK(curve.kind == ScoreOrder::similarity);
  CHECK(curve.positives == 5);  // frame 0 ends no window
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
  CHECK(test::error_kind([&] { set_confidence(without, Confidence::margin); }) == ErrorKind::usage);
  for (size_t window = 0; window < result.best.size(); ++window)
    result.margins.push_back(result.best[window] ? std::optional<double>(3 * window)
                                                 : std::nullopt);
  Judgment judgment = judge(result, truth, {});
  CHECK(judgment.single_best == without.single_best);
  REQUIRE(judgment.other_best);
  const Curve by_margin = *judgment.other_best;
  set_confidence(judgment, Confidence::margin);
  CHECK(judgment.single_best == by_margin);
  CHECK(judgment.other_best == without.single_best);
}

namespace {

// Ten query frames and ten training frames, c_l 3: windows 0 to 7, anchors 2 to 9.
Result example_result() {
  Result result = test::make_result(10, 3, 10);
  result.best.resize(8);
  return result;
}

GroundTruth aligned(int tolerance) {
  return read_ground_truth({"aligned", {}, tolerance}, {{"", 10}, {{"ref", 10}}});
}

}  // namespace

TEST_CASE("windows are evaluated at their anchors") {
  Result result = example_result();
  // Only anchors 5 and 5 are labeled the same: windows 3 and 3.
  GroundTruth truth;
  truth.pairs.resize(10);
  truth.pairs[5].push_back({0, 5, PlaceLabel::same});
  truth.pairs[6].push_back({0, 6, PlaceLabel::ignore});
  result.recognitions = {{3, 0, 3, 0, 5}, {3, 0, 4, 0, 5}, {4, 0, 4, 0, 5}, {5, 0, 5, 0, 5}};
  cluster(result);
  CHECK(count_recognitions(result, truth).recognitions == LabelCounts{1, 2, 1});
}

TEST_CASE("places are evaluated at their mean, and the correct ones are distinct") {
  Result result = example_result();
  result.clusters = {{{0, 3, 0, 6, 3, 0, 6, 5, 9}, {0, 1, 1, 1, 7, 7, 7, 1, 9}}, {}};
  const Counts counts = count_recognitions(result, aligned(0));
  CHECK(counts.clusters == LabelCounts{1, 1, 0});
  CHECK(counts.distinct == 1);
}

TEST_CASE("recognitions by place have the verdict on their place") {
  Result result = example_result();
  // Clusters around (2, 2), (6, 6) and at (0, 7); the pairs (2, 2) and (5, 5) are correct one by
  // one, and (6, 6) is ignored.
  GroundTruth truth;
  truth.pairs.resize(10);
  truth.pairs[4].push_back({0, 4, PlaceLabel::same});
  truth.pairs[7].push_back({0, 7, PlaceLabel::same});
  truth.pairs[8].push_back({0, 8, PlaceLabel::ignore});
  result.recognitions = {{0, 0, 7, 0, 5}, {1, 0, 1, 0, 5}, {2, 0, 2, 0, 5}, {3, 0, 3, 0, 5},
                         {5, 0, 5, 0, 5}, {6, 0, 6, 0, 5}, {7, 0, 7, 0, 5}};
  cluster(result);
  REQUIRE(result.clusters->all.size() == 3);
  const Counts counts = count_recognitions(result, truth);
  CHECK(counts.recognitions == LabelCounts{2, 4, 1});
  CHECK(counts.recognitions_by_place == LabelCounts{3, 1, 3});
  result.clusters.reset();
  CHECK_FALSE(count_recognitions(result, truth).recognitions_by_place);
}

TEST_CASE("a place that is correct at its mean counts its incorrect recognitions") {
  Result result = example_result();
  // One cluster around (3, 3), in which only the diagonal is correct; one separate incorrect
  // recognition.
  result.recognitions = {{2, 0, 2, 0, 5}, {2, 0, 4, 0, 5}, {3, 0, 3, 0, 5},
                         {4, 0, 2, 0, 5}, {4, 0, 4, 0, 5}, {7, 0, 0, 0, 5}};
  cluster(result);
  const std::vector<JudgedCluster> judged = judge_clusters(result, aligned(0));
  REQUIRE(judged.size() == 2);
  CHECK((judged[0].label == PlaceLabel::same && judged[0].is_mixed()));
  CHECK(judged[0].recognitions == LabelCounts{3, 2, 0});
  CHECK((judged[1].label == PlaceLabel::different && !judged[1].is_mixed()));
  const Counts counts = count_recognitions(result, aligned(0));
  CHECK(counts.recognitions == LabelCounts{3, 3, 0});
  CHECK(counts.clusters == LabelCounts{1, 1, 0});
  CHECK(counts.mixed_clusters == 1);
  CHECK(count_recognitions(result, aligned(9)).mixed_clusters == 0);
}

TEST_CASE("best matches count over all frames that have a match") {
  Result result = example_result();
  GroundTruth truth;
  truth.pairs.resize(10);
  for (uint32_t frame = 1; frame <= 7; ++frame)
    truth.pairs[frame].push_back({0, frame, PlaceLabel::same});
  truth.pairs[7].push_back({0, 9, PlaceLabel::ignore});
  // No window ends at frame 1, and frames 0, 8 and 9 have no match.
  for (uint32_t window = 0; window < 8; ++window)
    result.best[window] = Match{window, 0, window, 0, 5};
  result.best[1] = Match{1, 0, 7, 0, 5};  // incorrect
  result.best[2] = std::nullopt;          // an unreadable frame
  result.query.unreadable = {2};
  result.best[5] = Match{5, 0, 7, 0, 5};  // anchors 7 and 9: ignored
  const BestMatchCounts best = best_match_counts(outcomes_of(result, truth));
  CHECK(best == BestMatchCounts{7, 3, 1, 1, 2, 3});
  CHECK(*best.rate() == Approx(3 / 7.0));
}

TEST_CASE("a place before the first training anchor counts as not recognized") {
  Result result = example_result();
  GroundTruth truth;
  truth.pairs.resize(10);
  truth.pairs[2] = {{0, 0, PlaceLabel::same}};  // no window ends before frame 2
  truth.pairs[4] = {{0, 2, PlaceLabel::same}};
  for (uint32_t window = 0; window < 8; ++window) result.best[window] = Match{window, 0, 0, 0, 5};
  CHECK(best_match_counts(outcomes_of(result, truth)) == BestMatchCounts{2, 1, 1, 0, 0, 8});
}

TEST_CASE("a stop counts once if counts are per keyframe") {
  Result result = example_result();
  CHECK_FALSE(count_by_keyframe(result, aligned(0), {}));
  result.keyframes = ResultKeyframes{{0, 1, 2, 3, 7}, {{0, 1, 2, 3, 4, 8}}};
  // Query keyframes of anchors: 2; 3 to 6; 7 to 9. Training keyframes: 2; 3; 4 to 7; 8 and 9.
  for (uint32_t window = 0; window < 8; ++window)
    result.best[window] = Match{window, 0, window, 0, 5};
  result.best[2] = Match{2, 0, 7, 0, 5};
  result.best[5] = result.best[6] = result.best[7] = Match{5, 0, 0, 0, 5};
  result.recognitions = {{0, 0, 0, 0, 1}, {1, 0, 6, 0, 1}, {1, 0, 7, 0, 1}, {2, 0, 2, 0, 1},
                         {2, 0, 3, 0, 1}, {3, 0, 6, 0, 1}, {6, 0, 7, 0, 1}, {7, 0, 6, 0, 1}};
  Outcomes outcomes = outcomes_of(result, aligned(0));
  const CountsByKeyframe counts = *count_by_keyframe(result, aligned(0), outcomes);
  CHECK(counts.query_keyframes == 5);
  CHECK(counts.train_keyframes == 6);
  // Correct: 2 and 2. Incorrect: 3 to 6 and 8 to 9, and 7 to 9 and 8 to 9. Mixed: 3 to 6 and 4 to
  // 7, for frames 4 and 4, and 4 and 5.
  CHECK(counts.recognitions == KeyframeCounts{1, 2, 1, 0});
  // No window ends in the first two keyframes.
  CHECK(counts.best_match == KeyframeCounts{1, 3, 1, 0});
  CHECK(*counts.best_match_rate == Approx((1 + 0.75 + 0) / 5));
  for (QueryOutcome& query : outcomes.queries)
    if (query.verdict == Verdict::incorrect) query.verdict = Verdict::ignored;
  CHECK(count_by_keyframe(result, aligned(0), outcomes)->best_match == KeyframeCounts{2, 2, 0, 1});
}

TEST_CASE("recall of keyframes counts a stop once, by its most confident frame") {
  Result result = example_result();
  result.keyframes = ResultKeyframes{{0, 1, 2, 3, 7}, {{0, 1, 2, 3, 4, 8}}};
  for (uint32_t window = 0; window < 8; ++window)
    result.best[window] = Match{window, 0, window, 0, 5};
  // The stop of frames 3 to 6 is best at frame 4, whose match is another frame of the right
  // keyframe.
  result.best[2] = Match{2, 0, 4, 0, 1};
  const auto recall = [&] {
    const Outcomes outcomes = outcomes_of(result, aligned(0));
    return *count_by_keyframe(result, aligned(0), outcomes)->recall_at_full_precision;
  };
  CHECK(recall() == Approx(3 / 5.0));     // no window ends in the first two keyframes
  result.best[5] = Match{5, 0, 0, 0, 2};  // frame 7, in a wrong keyframe, after frame 4
  CHECK(recall() == Approx(1 / 5.0));
}

TEST_CASE("without queries there is no rate") { CHECK_FALSE(BestMatchCounts{}.rate().has_value()); }
