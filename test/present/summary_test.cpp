// The headline of an evaluation.
#include "present/summary.h"

#include <catch2/catch.hpp>

#include "present/result_text.h"
#include "support.h"

using namespace vpr;
using test::has;

namespace {

/// One letter per query frame: r(ecognized correctly), w(rongly), i(gnored), . none; W, I and ,
/// have no match in the ground truth.
Evaluation evaluation_of(const std::string& letters) {
  Evaluation evaluation;
  Judgment& judgment = evaluation.judgment;
  for (const char letter : letters) {
    QueryOutcome& query = judgment.outcomes.queries.emplace_back();
    query.frame = judgment.outcomes.queries.size() - 1;
    query.has_match = letter != 'W' && letter != 'I' && letter != ',';
    judgment.verdicts.push_back(letter == 'r'                    ? Verdict::correct
                                : letter == 'w' || letter == 'W' ? Verdict::incorrect
                                : letter == 'i' || letter == 'I' ? Verdict::ignored
                                                                 : Verdict::none);
  }
  judgment.localization = localize(judgment.verdicts, {});
  for (const QueryOutcome& query : judgment.outcomes.queries) {
    judgment.localization.frames_with_match += query.has_match;
    judgment.localization.off_map +=
        !query.has_match && judgment.verdicts[query.frame] == Verdict::incorrect;
  }
  evaluation.result.emplace().result = std::make_shared<const Result>();
  return evaluation;
}

std::string summary(const std::string& letters, std::optional<double> fps = {}) {
  return summary_sentence(evaluation_of(letters), fps);
}

}  // namespace

TEST_CASE("the headline counts frames with a match, and their errors") {
  CHECK(
      summary(".wr.i") ==
      "3 of 5 frames recognized, 1 of them incorrectly, 1 to be ignored. The first correct one is "
      "confirmed at frame 2.");
  CHECK(summary(".rr", 4.0) ==
        "2 of 3 frames recognized, all correctly. The first is confirmed at frame 1 (0.2 s).");
  CHECK(summary("..", 10.0) == "None of 2 frames recognized.");
  CHECK(summary("r.W,,") ==
        "1 of 2 frames with a match recognized, all correctly; 1 of 3 frames without a match "
        "recognized, which is incorrect. The first is confirmed at frame 0.");
  CHECK(summary("r.III") ==
        "1 of 2 frames with a match recognized, all correctly. The first is confirmed at frame 0.");
}

TEST_CASE("the headline counts incorrect pairs next to correct frames") {
  Evaluation evaluation = evaluation_of("r.");
  evaluation.result->counts.recognitions = {227, 412, 0};
  CHECK(summary_sentence(evaluation, {}) ==
        "1 of 2 frames recognized, its best match correct; 412 of the 639 accepted window "
        "pairs are incorrect. The first is confirmed at frame 0.");
  evaluation.truth.asked = {{{}}, {{}}};
  evaluation.result->counts.recognitions = {20, 2, 500};
  CHECK_FALSE(has(summary_sentence(evaluation, {}), "pair"));
  evaluation = evaluation_of("rW,");
  evaluation.result->counts.recognitions = {1, 1, 0};  // one pair per frame
  CHECK_FALSE(has(summary_sentence(evaluation, {}), "pair"));
}

TEST_CASE("the headline of a sample of labels is an estimate with its interval") {
  Evaluation evaluation = evaluation_of(std::string(44, 'r') + "w....." + std::string(50, ','));
  evaluation.truth.asked.resize(100);
  evaluation.truth.is_sample = true;
  for (size_t q = 0; q < 50; ++q)
    evaluation.judgment.outcomes.queries[q].verdict =
        q < 47 ? Verdict::correct : Verdict::incorrect;
  CHECK(
      summary_sentence(evaluation, {}) ==
      "Best match correct, estimated from 50 frames spread along the query: 94 % (84 to 98 %). 45 "
      "of these frames recognized, 1 of them incorrectly (0 to 12 %).");
  evaluation.judgment.outcomes.queries[3].verdict = Verdict::ignored;
  CHECK(has(summary_sentence(evaluation, {}), "1 of their best matches"));
}

TEST_CASE("without a ground truth nothing is judged, and answers to places may be missing") {
  Evaluation evaluation = evaluation_of(".i");
  evaluation.judgment.by = JudgedBy::nothing;
  CHECK(summary_sentence(evaluation, 10.0) ==
        "1 of 2 frames recognized (50.0 %). Nothing is judged without a ground truth.");
  evaluation.judgment.by = JudgedBy::places;
  CHECK(summary_sentence(evaluation, 10.0) == "1 of 2 frames recognized, 1 without an answer.");
  evaluation = evaluation_of("ri.");
  evaluation.judgment.by = JudgedBy::places;
  evaluation.result->counts.recognitions_by_place = LabelCounts{3, 5, 2};
  CHECK(summary_sentence(evaluation, {}) ==
        "2 of 3 frames recognized, 1 correctly, 1 without an answer; 5 of the 8 accepted labeled "
        "window pairs are incorrect. The first is confirmed at frame 0.");
}

TEST_CASE("speeds are in time if the rates differ") {
  Result result;
  result.settings = SequenceQuerySettings{Threshold{{.window_length = 1}}};
  result.query = {"query", 40};
  result.sequences.emplace_back().sequence = {"walk", 40};
  result.clusters = Clusters{{{0, 10, 0, 20, 10, 0, 20, 1, 0}}, {0}};
  const auto text = [&] { return range_text(result, recognized_ranges(result).front()); };
  CHECK(text() == "query 0-20 = walk 0-20, 1.0x");
  result.query.fps = 30;
  CHECK(text() == "query 0-20 = walk 0-20, 1.0x");
  result.sequences[0].sequence.fps = 8;
  CHECK(text() == "query 0-20 = walk 0-20, 3.8x in time; 1.00 frames per frame");
}
