#include "evaluate/counts.h"

#include <catch2/catch.hpp>

using namespace vpr;

namespace {

// Ten query frames and ten training frames, c_l 3: windows 0 to 7, anchors 2 to 9.
Result example() {
  Result result;
  SequenceQuerySettings settings;
  settings.window_length = 3;
  result.settings = settings;
  result.query.frames = 10;
  result.query_windows = 8;
  result.targets = {{{"ref", 10}, 8, true, 0.5, ThresholdScale::relative, 10, 100}};
  result.best.resize(8);
  return result;
}

GroundTruth aligned(int tolerance) {
  return read_ground_truth({"aligned", {}, tolerance}, {{"", 10}, {{"ref", 10}}});
}

}  // namespace

TEST_CASE("windows are evaluated at their anchors") {
  Result result = example();
  // Only anchors 5 and 5 are labeled the same: windows 3 and 3.
  GroundTruth truth;
  truth.pairs.resize(10);
  truth.pairs[5].push_back({0, 5, PlaceLabel::same});
  truth.pairs[6].push_back({0, 6, PlaceLabel::ignore});
  result.recognitions = {{3, 0, 3, 0, 5}, {3, 0, 4, 0, 5}, {4, 0, 4, 0, 5}, {5, 0, 5, 0, 5}};
  cluster(result);
  const Counts counts = count_recognitions(result, truth);
  CHECK(counts.recognitions.correct == 1);
  CHECK(counts.recognitions.incorrect == 2);
  CHECK(counts.recognitions.ignored == 1);
}

TEST_CASE("places are evaluated at their mean, and the correct ones are distinct") {
  Result result = example();
  result.clusters = {{{0, 3, 0, 6, 3, 0, 6, 5, 9}, {0, 1, 1, 1, 7, 7, 7, 1, 9}}, {}};
  const Counts counts = count_recognitions(result, aligned(0));
  CHECK(counts.clusters->correct == 1);
  CHECK(counts.clusters->incorrect == 1);
  CHECK(counts.distinct == 1);
}

TEST_CASE("a place that is correct at its mean counts its incorrect recognitions") {
  Result result = example();
  // One cluster around (3, 3), in which only the diagonal is correct; one separate incorrect
  // recognition.
  result.recognitions = {{2, 0, 2, 0, 5}, {2, 0, 4, 0, 5}, {3, 0, 3, 0, 5},
                         {4, 0, 2, 0, 5}, {4, 0, 4, 0, 5}, {7, 0, 0, 0, 5}};
  cluster(result);
  const std::vector<JudgedCluster> judged = judge_clusters(result, *result.clusters, aligned(0));
  REQUIRE(judged.size() == 2);
  CHECK((judged[0].label == PlaceLabel::same && judged[0].is_mixed()));
  CHECK((judged[0].recognitions.correct == 3 && judged[0].recognitions.incorrect == 2));
  CHECK((judged[1].label == PlaceLabel::different && !judged[1].is_mixed()));
  const Counts counts = count_recognitions(result, aligned(0));
  CHECK((counts.recognitions.correct == 3 && counts.recognitions.incorrect == 3));
  CHECK((counts.clusters->correct == 1 && counts.clusters->incorrect == 1));
  CHECK(counts.mixed_clusters == 1);
  CHECK(count_recognitions(result, aligned(9)).mixed_clusters == 0);
}

TEST_CASE("best matches count over the windows that have a match") {
  Result result = example();
  GroundTruth truth;
  truth.pairs.resize(10);
  for (uint32_t anchor = 2; anchor <= 7; ++anchor)
    truth.pairs[anchor].push_back({0, anchor, PlaceLabel::same});
  truth.pairs[7].push_back({0, 9, PlaceLabel::ignore});
  // Windows 0 to 5 have matches (anchors 2 to 7), windows 6 and 7 do not.
  for (uint32_t window = 0; window < 8; ++window)
    result.best[window] = Match{window, 0, window, 0, 5};
  result.best[1] = Match{1, 0, 7, 0, 5};  // incorrect
  result.best[2] = std::nullopt;          // an unreadable frame
  result.query.unreadable = {2};
  result.best[5] = Match{5, 0, 7, 0, 5};  // anchors 7 and 9: ignored
  const BestMatchCounts best = count_recognitions(result, truth).best_match;
  CHECK(best.queries == 5);
  CHECK(best.correct == 3);
  CHECK(best.ignored == 1);
  CHECK(best.without_match == 2);
  CHECK(best.unreadable == 1);
  CHECK(best.rate() == 0.75);
}

TEST_CASE("a window without a match of an approximate method is incorrect") {
  Result result = example();
  result.best[4] = Match{4, 0, 4, 0, 5};
  const BestMatchCounts best = count_recognitions(result, aligned(0)).best_match;
  CHECK(best.queries == 8);
  CHECK(best.correct == 1);
  CHECK(best.unreadable == 0);
}

TEST_CASE("a place before the first training anchor cannot be found, and is counted separately") {
  Result result = example();
  result.targets.push_back({{"short", 2}, 0, true, 0.5, ThresholdScale::relative, 10, 100});
  GroundTruth truth;
  truth.pairs.resize(10);
  // No window ends before frame 2, and none in the short sequence.
  truth.pairs[2] = {{0, 0, PlaceLabel::same}};
  truth.pairs[3] = {{0, 1, PlaceLabel::same}};
  truth.pairs[4] = {{0, 0, PlaceLabel::same, 2}};
  truth.pairs[5] = {{0, 2, PlaceLabel::ignore}, {1, 1, PlaceLabel::same}};
  truth.pairs[6] = {{0, 9, PlaceLabel::same}};
  for (uint32_t window = 0; window < 8; ++window) result.best[window] = Match{window, 0, 0, 0, 5};
  const auto best = [&] { return count_recognitions(result, truth).best_match; };
  CHECK(best().queries == 2);  // anchors 4 and 6
  CHECK(best().correct == 1);
  CHECK(best().unreachable == 3);
  CHECK(best().without_match == 3);
  truth.tolerance_frames = 1;  // frame 1 is within the tolerance of anchor 2
  CHECK(best().queries == 3);
  CHECK(best().unreachable == 2);
}

TEST_CASE("a stop counts once if counts are per keyframe") {
  Result result = example();
  CHECK_FALSE(count_by_view(result, aligned(0)));
  result.views = ResultViews{{0, 1, 2, 3, 7}, {{0, 1, 2, 3, 4, 8}}};
  // Query keyframes of anchors: 2; 3 to 6; 7 to 9. Training keyframes: 2; 3; 4 to 7; 8 and 9.
  for (uint32_t window = 0; window < 8; ++window)
    result.best[window] = Match{window, 0, window, 0, 5};
  result.best[2] = Match{2, 0, 7, 0, 5};
  result.best[5] = result.best[6] = result.best[7] = Match{5, 0, 0, 0, 5};
  result.recognitions = {{0, 0, 0, 0, 1}, {1, 0, 6, 0, 1}, {1, 0, 7, 0, 1}, {2, 0, 2, 0, 1},
                         {2, 0, 3, 0, 1}, {3, 0, 6, 0, 1}, {6, 0, 7, 0, 1}, {7, 0, 6, 0, 1}};
  const CountsByView counts = *count_by_view(result, aligned(0));
  CHECK(counts.query_views == 5);
  CHECK(counts.train_views == 6);
  CHECK(counts.recognitions.correct == 1);  // 2 and 2
  CHECK(counts.recognitions.incorrect ==
        2);  // 3 to 6 and 8 to 9, three recognitions; 7 to 9 and 8 to 9, two
  CHECK(counts.recognitions.mixed == 1);  // 3 to 6 and 4 to 7: frames 4 and 4, 4 and 5
  CHECK(counts.best_match.correct == 1);
  CHECK(counts.best_match.mixed == 1);
  CHECK(counts.best_match.incorrect == 1);
  CHECK(*counts.best_match_rate == Approx((1 + 0.75 + 0) / 3));
}

TEST_CASE("without queries there is no rate") { CHECK_FALSE(BestMatchCounts{}.rate().has_value()); }
