#include "evaluate/evaluation.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "evaluate/place_answers.h"
#include "evaluate/report.h"
#include "support.h"

using namespace vpr;

namespace {

const EvaluationSettings kAligned = {GroundTruthArgument{"aligned", {}, 0}, {}, {}};

/// Four frames: the first two are recognized correctly, the third incorrectly, and the last one is
/// not recognized.
Result example() {
  Result result;
  result.settings = SequenceQuerySettings{Threshold{{.window_length = 1}}};
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

std::shared_ptr<const Result> shared(Result result) {
  return std::make_shared<const Result>(std::move(result));
}

}  // namespace

TEST_CASE("a result is evaluated and counted by one ground truth") {
  const Evaluation found = evaluate_result(shared(example()), {}, kAligned, {});
  CHECK(found.query().name == "walk");
  CHECK(found.truth.is_known);
  CHECK_FALSE(found.matrix);
  REQUIRE(found.result);
  const Counts& counts = found.result->counts;
  CHECK(counts.recognitions == LabelCounts{2, 1, 0});
  CHECK(counts.recognitions_by_place == LabelCounts{2, 1, 0});
  CHECK(counts.clusters == LabelCounts{1, 1, 0});
  CHECK((counts.best_match.frames == 4 && counts.best_match.correct == 2));
  REQUIRE(found.result->clusters.size() == 2);
  CHECK(found.result->clusters[0].label == PlaceLabel::same);
  CHECK(found.result->clusters[1].recognitions == LabelCounts{0, 1, 0});
  CHECK(found.judgment.verdicts == std::vector<Verdict>{Verdict::correct, Verdict::correct,
                                                        Verdict::incorrect, Verdict::none});
  CHECK_FALSE(found.judgment.localization.longest_gap_m);
  CHECK_FALSE(found.result->by_keyframe);
}

TEST_CASE("poses of the query yield distances in meters") {
  test::write_text("poses.csv", "frame,x,y\n0,0,0\n1,3,4\n2,3,5\n3,3,7\n");
  EvaluationSettings by = kAligned;
  by.poses = "poses.csv";
  const Evaluation found = evaluate_result(shared(example()), {}, by, {});
  CHECK(found.judgment.localization.first_recognition_m == 0);
  CHECK(found.judgment.localization.longest_gap_m == 5);
}

TEST_CASE("without ground truth, a result is shown without evaluation") {
  const Evaluation found = evaluate_result(shared(example()), {}, {}, {});
  CHECK_FALSE(found.truth.is_known);
  CHECK(found.result->counts.recognitions == LabelCounts{0, 0, 3});
  CHECK(found.judgment.verdicts[0] == Verdict::ignored);
  const Json report = report_json(report_of(found, {}));
  CHECK(report["judged"] == "nothing");
  CHECK(report["counts"]["clusters"]["ignored"] == 2);
  CHECK(report["localization"] ==
        Json{{"frames", 4}, {"recognized", 3}, {"recognized_share", 0.75}});
  for (const char* key : {"metrics", "curves", "best_match"}) CHECK_FALSE(report.contains(key));
  CHECK(test::error_kind([&] { parse_report(report, "r.json"); }) == ErrorKind::usage);
}

TEST_CASE("answers to places judge the places, their recognitions and the frames") {
  const auto judged_by = [&](const std::string& rows) {
    test::write_text("places.csv", "place,query,sequence,train,same\n" + rows);
    EvaluationSettings by;
    by.places = "places.csv";
    return evaluate_result(shared(example()), {}, by, {});
  };
  // The first place has two recognitions, at frames 0 and 1; the second one has frame 2.
  const Evaluation found = judged_by("2,2,ref,0,no\n1,0,ref,0,yes\n");
  CHECK_FALSE(found.truth.is_known);
  CHECK(found.judgment.by == JudgedBy::places);
  const Counts& counts = found.result->counts;
  CHECK(counts.recognitions == LabelCounts{0, 0, 3});
  CHECK(counts.recognitions_by_place == LabelCounts{2, 1, 0});
  CHECK(counts.clusters == LabelCounts{1, 1, 0});
  CHECK(counts.distinct == 1);
  CHECK(found.judgment.verdicts == std::vector<Verdict>{Verdict::correct, Verdict::correct,
                                                        Verdict::incorrect, Verdict::none});
  CHECK(found.judgment.localization.recognized == 3);
  CHECK(found.judgment.localization.correct == 2);
  CHECK(found.judgment.localization.longest_gap_frames == 2);
  const Json report = report_json(report_of(found, {}));
  CHECK(report["judged"] == "places");
  CHECK(report["localization"]["share"] == 0.5);
  for (const char* key : {"metrics", "curves", "best_match"}) CHECK_FALSE(report.contains(key));
  const Evaluation half = judged_by("2,2,ref,0,no\n");
  CHECK(half.result->counts.recognitions_by_place == LabelCounts{0, 1, 2});
  CHECK(half.result->counts.clusters == LabelCounts{0, 1, 1});
  CHECK(half.judgment.verdicts[0] == Verdict::ignored);
}

TEST_CASE("an answer judges at most 50 frames of a place, without a change of speed") {
  Result result = example();
  result.query.frames = result.query_windows = 300;
  result.sequences[0].sequence.frames = result.sequences[0].windows = 400;
  result.recognitions.clear();
  // One path: at the trained speed, from frame 120 on at twice this speed.
  for (uint32_t q = 0; q < 200; ++q)
    result.recognitions.push_back({q, 0, q < 120 ? q : 2 * q - 120, 0, 5});
  result.best.assign(300, std::nullopt);
  for (const Match& one : result.recognitions) result.best[one.query] = one;
  result.clusters->all = {{0, 100, 0, 199, 100, 0, 278, 200, 5}};
  result.clusters->of_recognition.assign(200, 0);
  const std::vector<PlacePart> parts = parts_of_places(result);
  std::vector<size_t> frames;
  std::string rows = "place,query,sequence,train,same\n";
  for (const PlacePart& part : parts) {
    frames.push_back(part.frames);
    rows += answer_row(result, part) + (part.recognitions.front() >= 120 ? ",no\n" : ",yes\n");
  }
  CHECK(frames == std::vector<size_t>{40, 40, 40, 40, 40});
  CHECK(answer_row(result, parts[1]) == "1,60,ref,60");
  CHECK(answer_row(result, parts[4]) == "1,180,ref,240");
  test::write_text("places.csv", rows);
  EvaluationSettings by;
  by.places = "places.csv";
  const Evaluation found = evaluate_result(shared(result), {}, by, {});
  CHECK(found.judgment.localization.correct == 120);
  CHECK(found.judgment.localization.incorrect == 80);
  CHECK(found.result->counts.recognitions_by_place == LabelCounts{120, 80, 0});
  CHECK(found.result->counts.clusters == LabelCounts{1, 0, 0});  // by its middle part
  CHECK(found.result->answers->answers == 5);
  CHECK(found.result->answers->most_frames == 40);
  CHECK(found.truth.protocol == "5 answers to 5 parts of 1 place");
}

TEST_CASE("a sample of labels estimates the share of correct best matches, and sets a threshold") {
  test::write_text("labels.csv",
                   "query,reference,label,tolerance,asked\n0,0,same,0,spread\n1,1,same,0,spread\n"
                   "2,0,different,0,decision\n");
  EvaluationSettings by;
  by.ground_truth = GroundTruthArgument{"labels", "labels.csv", 0};
  const Evaluation found = evaluate_result(shared(example()), {}, by, {});
  REQUIRE(estimated_recall(found));
  CHECK(estimated_recall(found)->frames == 2);
  CHECK(estimated_recall(found)->rate == 1);
  CHECK(labeled_threshold(found)->labels == 3);
  CHECK(labeled_threshold(found)->threshold == 7);
  CHECK(labeled_threshold(found)->accepted == 2);
  CHECK(report_json(report_of(found, {}))["estimate"]["frames"] == 2);
  // Copies of frames are not independent.
  Result slow = example();
  slow.query.selection = {"0.5", 1, 4, {0, 0, 1, 2}};
  CHECK_FALSE(estimated_recall(evaluate_result(shared(slow), {}, by, {})));
  // The label of a frame of the sample that is of another match estimates nothing.
  test::write_text(
      "labels.csv",
      "query,reference,label,tolerance,asked\n0,0,same,0,spread\n1,3,different,0,spread\n");
  CHECK_FALSE(estimated_recall(evaluate_result(shared(example()), {}, by, {})));
}

TEST_CASE("a ground truth that begins elsewhere, or has no match, is warned of") {
  std::string pairs = "query,reference\n";
  for (int i = 0; i < 4; ++i) pairs += fmt::format("{},{}\n", i, i + 30);
  test::write_text("later.csv", pairs);
  test::write_text("q.csv", "frame,x,y\n0,0,0\n1,1,0\n2,2,0\n3,3,0\n");
  test::write_text("t.csv", "frame,x,y\n0,900,0\n1,901,0\n2,902,0\n3,903,0\n");
  const test::Warnings warnings;
  Result result = example();
  result.sequences[0].sequence.frames = result.sequences[0].windows = 40;
  EvaluationSettings by;
  by.ground_truth = GroundTruthArgument{"", "later.csv", 0};
  evaluate_result(shared(result), {}, by, warnings.monitor);
  REQUIRE(warnings.said.size() == 1);
  CHECK(test::has(warnings.said[0],
                  "3 of 3 matches are about 30 frames before what the ground truth says"));
  by.ground_truth = GroundTruthArgument{"", "q.csv", 0};
  by.ground_truth->options.reference = "t.csv";
  by.ground_truth->options.radius_m = 3;
  evaluate_result(shared(example()), {}, by, warnings.monitor);
  REQUIRE(warnings.said.size() == 2);
  CHECK(test::has(warnings.said[1], "no training frame is within 3 m of a query frame"));
}

TEST_CASE("an estimated share has the interval of Wilson") {
  const Estimate found = estimate_share(47, 50);
  CHECK(found.rate == 0.94);
  CHECK(found.interval.low == Approx(0.8378).margin(5e-5));  // statsmodels 0.13, method wilson
  CHECK(found.interval.high == Approx(0.9794).margin(5e-5));
  CHECK(estimate_share(0, 10).interval.low == Approx(0).margin(1e-12));
  CHECK(estimate_share(10, 10).interval.high == Approx(1));
}

TEST_CASE("answers that do not fit the places of a result are refused, with their line") {
  const auto error = [&](const std::string& text, Result result = example()) {
    test::write_text("p.csv", text);
    return test::error_text([&] { read_place_answers("p.csv", result, parts_of_places(result)); });
  };
  const std::string header = "place,query,sequence,train,same\n";
  using Catch::Contains;
  CHECK_THAT(error(""), Contains("has no column place"));
  CHECK_THAT(error(header), Contains("has no answers"));
  for (const char* row : {"0,0,ref,0,yes", "3,0,ref,0,yes", "1,1,ref,0,yes", "1,0,ref,1,yes",
                          "1,0,other,0,yes", "2,0,ref,0,yes", "-1,0,ref,0,yes", "x,0,ref,0,yes"})
    CHECK_THAT(error(header + row + "\n"), Contains("line 2: the result has no place"));
  CHECK_THAT(error(header + "1,0,ref,0,yes\n1,0,ref,0,no\n"), Contains("line 3: place 1 has two"));
  CHECK_THAT(error(header + "1,0,ref,0,sure\n"), Contains("\"same\" is \"sure\""));
  Result places = example();
  places.clusters.reset();
  CHECK_THAT(error(header, places), Contains("FAB-MAP has none"));
}

TEST_CASE("without clusters, every recognition of a result is evaluated separately") {
  Result result = example();
  result.settings = FabmapQuerySettings{};
  result.clusters.reset();
  result.places.emplace().names = {"a", "b", "c", "d"};
  const Evaluation found = evaluate_result(shared(std::move(result)), {}, kAligned, {});
  REQUIRE(found.result->clusters.size() == 3);
  CHECK(found.result->clusters[1].label == PlaceLabel::same);
  CHECK(found.result->clusters[2].label == PlaceLabel::different);
  CHECK(found.result->counts.distinct == 2);
}

TEST_CASE("scores alone are evaluated by their best matches, and a saved matrix by its pairs") {
  const std::vector<int32_t> scores = {5, 9, 9, 9,  //
                                       9, 6, 9, 9,  //
                                       7, 9, 8, 9,  //
                                       9, 9, 9, 9};
  test::write_array<int32_t>("s.npy", scores, {4, 4});
  ScoreSettings settings;
  settings.threshold = 7;
  settings.query.name = "theirs";
  const auto matrix = [&] { return ScoreMatrix("s.npy", settings.format); };
  const Evaluation alone = evaluate_scores(matrix(), settings, kAligned, {});
  CHECK(alone.query().name == "theirs");
  CHECK_FALSE(alone.result);
  CHECK(alone.fingerprint == matrix().fingerprint({}));
  CHECK(alone.judgment.verdicts == std::vector<Verdict>{Verdict::correct, Verdict::correct,
                                                        Verdict::incorrect, Verdict::none});
  REQUIRE(alone.judgment.all_pairs);

  Result result = example();
  CHECK(test::error_kind([&] { evaluate_result(shared(result), matrix(), kAligned, {}); }) ==
        ErrorKind::data);  // another best match
  result.best.back() = Match{3, 0, 0, 0, 9};
  const Evaluation both = evaluate_result(shared(result), matrix(), kAligned, {});
  REQUIRE(both.matrix);
  REQUIRE(both.judgment.all_pairs);
  CHECK(both.judgment.all_pairs->curve.points.size() ==
        alone.judgment.all_pairs->curve.points.size());
  CHECK(both.judgment.verdicts == alone.judgment.verdicts);
  CHECK(both.result->counts.recognitions.correct == 2);
}
