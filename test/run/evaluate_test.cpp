#include "run/evaluate.h"

#include <catch2/catch.hpp>

#include "support.h"

using namespace vpr;

namespace {

const EvaluationSettings kAligned = {GroundTruthArgument{"aligned", {}, 0}, {}, {}};

/// Four frames: the first two are recognized correctly, the third incorrectly, and the last one is
/// not recognized.
Result example() {
  Result result;
  SequenceQuerySettings settings;
  settings.window_length = 1;
  result.settings = settings;
  result.query.name = "walk";
  result.query.frames = result.query_windows = 4;
  ComparedSequence& compared = result.sequences.emplace_back();
  compared.sequence = {"ref", 4};
  compared.windows = 4;
  result.recognitions = {{0, 0, 0, 0, 5}, {1, 0, 1, 0, 6}, {2, 0, 0, 0, 7}};
  for (const Match& recognition : result.recognitions) result.best.emplace_back(recognition);
  result.best.emplace_back();
  Clusters& clusters = result.clusters.emplace();
  clusters.all = {{0, 0, 0, 1, 0, 0, 1, 2, 5}, {0, 2, 2, 2, 0, 0, 0, 1, 7}};
  clusters.of_recognition = {0, 0, 1};
  return result;
}

std::vector<uint64_t> numbers(const LabelCounts& counts) {
  return {counts.correct, counts.incorrect, counts.ignored};
}

}  // namespace

TEST_CASE("a result is evaluated and counted by one ground truth") {
  const Evaluation found = evaluate_result(example(), {}, kAligned, {});
  CHECK(found.query().name == "walk");
  CHECK(found.truth.is_known);
  CHECK_FALSE(found.matrix);
  REQUIRE(found.result);
  const Counts& counts = found.result->counts;
  CHECK(numbers(counts.recognitions) == std::vector<uint64_t>{2, 1, 0});
  CHECK(numbers(*counts.recognitions_by_place) == std::vector<uint64_t>{2, 1, 0});
  CHECK(numbers(*counts.clusters) == std::vector<uint64_t>{1, 1, 0});
  CHECK((counts.best_match.queries == 4 && counts.best_match.correct == 2));
  REQUIRE(found.result->clusters.size() == 2);
  CHECK(found.result->clusters[0].label == PlaceLabel::same);
  CHECK(numbers(found.result->clusters[1].recognitions) == std::vector<uint64_t>{0, 1, 0});
  CHECK(found.judgment.verdicts ==
        std::vector<FrameVerdict>{FrameVerdict::correct, FrameVerdict::correct,
                                  FrameVerdict::incorrect, FrameVerdict::none});
  CHECK_FALSE(found.judgment.localization.longest_gap_m);
  CHECK_FALSE(found.result->by_keyframe);
}

TEST_CASE("poses of the query yield distances in meters") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "poses.csv", "frame,x,y\n0,0,0\n1,3,4\n2,3,5\n3,3,7\n");
  EvaluationSettings by = kAligned;
  by.poses = folder / "poses.csv";
  const Evaluation found = evaluate_result(example(), {}, by, {});
  CHECK(found.judgment.localization.first_recognition_m == 0);
  CHECK(found.judgment.localization.longest_gap_m == 5);
}

TEST_CASE("without ground truth, a result is shown without evaluation") {
  const Evaluation found = evaluate_result(example(), {}, {}, {});
  CHECK_FALSE(found.truth.is_known);
  CHECK(numbers(found.result->counts.recognitions) == std::vector<uint64_t>{0, 0, 3});
  CHECK(found.judgment.verdicts[0] == FrameVerdict::unjudged);
}

TEST_CASE("without clusters, every recognition of a result is evaluated separately") {
  Result result = example();
  result.settings = FabmapQuerySettings{};
  result.clusters.reset();
  result.places.emplace().names = {"a", "b", "c", "d"};
  const Evaluation found = evaluate_result(std::move(result), {}, kAligned, {});
  REQUIRE(found.result->clusters.size() == 3);
  CHECK(found.result->clusters[1].label == PlaceLabel::same);
  CHECK(found.result->clusters[2].label == PlaceLabel::different);
  CHECK(found.result->counts.distinct == 2);
}

TEST_CASE("scores alone are evaluated by their best matches, and a saved matrix by its pairs") {
  const test::TemporaryFolder folder;
  const std::vector<int32_t> scores = {5, 9, 9, 9,  //
                                       9, 6, 9, 9,  //
                                       7, 9, 8, 9,  //
                                       9, 9, 9, 9};
  test::write_array<int32_t>(folder / "s.npy", scores, {4, 4});
  ScoreSettings settings;
  settings.threshold = 7;
  settings.query.name = "theirs";
  const auto matrix = [&] { return ScoreMatrix(folder / "s.npy", settings.format); };
  const Evaluation alone = evaluate_scores(matrix(), settings, kAligned, {});
  CHECK(alone.query().name == "theirs");
  CHECK_FALSE(alone.result);
  CHECK(alone.fingerprint == matrix().fingerprint({}));
  CHECK(alone.judgment.verdicts ==
        std::vector<FrameVerdict>{FrameVerdict::correct, FrameVerdict::correct,
                                  FrameVerdict::incorrect, FrameVerdict::none});
  REQUIRE(alone.judgment.all_pairs);

  const Evaluation both = evaluate_result(example(), matrix(), kAligned, {});
  REQUIRE(both.matrix);
  REQUIRE(both.judgment.all_pairs);
  CHECK(both.judgment.all_pairs->curve.points.size() ==
        alone.judgment.all_pairs->curve.points.size());
  CHECK(both.judgment.verdicts == alone.judgment.verdicts);
  CHECK(both.result->counts.recognitions.correct == 2);
}
