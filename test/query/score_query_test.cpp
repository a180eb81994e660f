// Queries with z-scores: thresholds, searched sequences, comparison with their reference.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "examples.h"
#include "queries.h"
#include "query/prepare.h"
#include "query/run_query.h"
#include "query/train_sequences.h"
#include "reference/reference.h"
#include "reference/verified_query.h"
#include "support.h"

using namespace vpr;
using test::make_query;

namespace {

SequenceDatabase make_score_database(const std::vector<std::vector<LdbCode>>& sequences) {
  SequenceDatabase database = test::make_database(sequences);
  ensure_statistics(database, {});
  return database;
}

SequenceQuerySettings scored(uint64_t length, double threshold) {
  return {Threshold{{.window_length = length, .score = Score::zscore}, threshold}};
}

QueryRun query_scores(const SequenceDatabase& database, const DescriptorSet& query,
                      const SequenceQuerySettings& settings, size_t verify = 50) {
  return test::run_verified(plan_query(prepare(database, settings), query, "q", settings, {}, {}),
                            verify);
}

}  // namespace

TEST_CASE("z-scores recognize a revisit, with the same result for every method") {
  const std::vector<std::vector<LdbCode>> train = {test::walk_codes(60, 1),
                                                   test::walk_codes(45, 2)};
  std::vector<LdbCode> query = test::walk_codes(50, 3);
  std::copy_n(train[0].begin() + 10, 20, query.begin() + 15);
  const SequenceDatabase database = make_score_database(train);
  SequenceQuerySettings settings = scored(5, -4);
  const Result result = query_scores(database, make_query(query), settings).result;
  REQUIRE_FALSE(result.recognitions.empty());
  CHECK(result.sequences[0].scale == ThresholdScale::mean_z);
  for (const Match& recognition : result.recognitions) {
    CHECK(recognition.sequence == 0);
    CHECK(result.score().frame_value(recognition.score, 5) < -4);
  }
  CHECK(result.best[18]->train == 13);
  std::get<Threshold>(settings.rule).windows.method = "fastable-online";
  CHECK(query_scores(database, make_query(query), settings).result.recognitions ==
        result.recognitions);
}

TEST_CASE("rows are centered over all training frames, also in a limited search") {
  const std::vector<std::vector<LdbCode>> train = {test::walk_codes(30, 1), test::walk_codes(50, 2),
                                                   test::walk_codes(30, 3)};
  const SequenceDatabase database = make_score_database(train);
  SequenceQuerySettings settings = scored(5, 0);
  const DescriptorSet query = make_query(test::walk_codes(40, 4));
  const Result all = query_scores(database, query, settings).result;
  settings.only_sequences = {"b"};
  const Result one = query_scores(database, query, settings).result;
  std::vector<Match> expected;
  for (const Match& recognition : all.recognitions)
    if (recognition.sequence == 1) expected.push_back(recognition);
  CHECK(expected.size() > 46 * 9);
  CHECK(one.recognitions == expected);
}

TEST_CASE("a wrong score is detected, and a correct one is accepted") {
  const std::vector<std::vector<LdbCode>> train = {test::walk_codes(30, 1),
                                                   test::walk_codes(30, 2)};
  const SequenceDatabase database = make_score_database(train);
  const SequenceQuerySettings settings = scored(4, 0);
  const DescriptorSet query = make_query(test::walk_codes(40, 4));
  const QueryRun run = query_scores(database, query, settings, 2 * 27 * 37);  // all cells
  const auto cell_of = [&](const Match& recognition) {
    return Cell{recognition.query, recognition.sequence, recognition.train,
                uint32_t(recognition.score + double(score_offset(4)))};
  };
  const Cell right = cell_of(run.result.recognitions[300]);
  std::vector<Cell> cells = {cell_of(run.result.recognitions[100]), right};
  cells[1].score += 10;  // two units per frame
  const auto wrong = wrong_scores(cells, descriptor_spans(database), {query.rows(), {}}, 4,
                                  *stages_of(settings, &*database.statistics).basis, {});
  REQUIRE(wrong.size() == 1);
  CHECK(wrong[0].train_window == cells[1].train_window);
  CHECK(std::abs(int64_t{wrong[0].score} - int64_t{right.score}) <= 4);
}

TEST_CASE("missing statistics of a database are computed") {
  SequenceDatabase database = make_score_database({test::walk_codes(30, 1)});
  const auto stored = database.statistics;
  ensure_statistics(database, {});
  CHECK(database.statistics == stored);
  database.statistics.reset();
  const SequenceQuerySettings settings = scored(4, 0);
  const DescriptorSet query = make_query(test::walk_codes(40, 4));
  CHECK(test::error_kind([&] { query_scores(database, query, settings); }) == ErrorKind::usage);
  ensure_statistics(database, {});
  CHECK(database.statistics == stored);
}
