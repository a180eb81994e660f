#include <algorithm>
#include <tuple>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "examples.h"
#include "queries.h"
#include "query/advice.h"
#include "query/run_query.h"
#include "query/thresholds.h"
#include "query/train_sequences.h"
#include "reference/reference.h"
#include "reference/sampled_cells.h"
#include "reference/verified_query.h"
#include "support.h"

using namespace vpr;
using test::by_margin;
using test::by_threshold;
using test::make_query;

namespace {

SequenceDatabase make_database(const std::vector<std::vector<LdbCode>>& sequences,
                               size_t window_length) {
  SequenceDatabase database = test::make_database(sequences);
  database.thresholds.push_back(
      compute_thresholds(descriptor_spans(database), window_length, 1, {}));
  return database;
}

QueryRun query_all(const SequenceDatabase& database, const DescriptorSet& query,
                   const SequenceQuerySettings& settings, const Monitor& monitor = {}) {
  const QueryPlan plan = plan_query(prepare(database, settings), query, "q", settings, {}, monitor);
  return plan.match.method->is_approximate() ? run_query(plan, {}, monitor)
                                             : test::run_verified(plan, 50, monitor);
}

// Recognitions by definition, with a division per cell.
std::vector<Match> slow_recognitions(const std::vector<std::vector<LdbCode>>& train,
                                     const std::vector<LdbCode>& query, size_t length,
                                     double threshold) {
  std::vector<Match> recognitions;
  for (size_t s = 0; s < train.size(); ++s) {
    const auto distances = test::reference_openable(train[s], query, length);
    const double most = *std::max_element(distances.begin(), distances.end());
    const size_t cols = train[s].size() - length + 1;
    for (size_t x = 0; x < distances.size(); ++x)
      if (distances[x] / most < threshold)
        recognitions.push_back(
            {uint32_t(x / cols), uint32_t(s), uint32_t(x % cols), 0, double(distances[x])});
  }
  std::sort(recognitions.begin(), recognitions.end(), [](const Match& a, const Match& b) {
    return std::tie(a.query, a.sequence, a.train) < std::tie(b.query, b.sequence, b.train);
  });
  return recognitions;
}

}  // namespace

TEST_CASE("relative thresholds use the final maximum of each training sequence") {
  const std::vector<std::vector<LdbCode>> train = {test::walk_codes(60, 1),
                                                   test::walk_codes(45, 2)};
  std::vector<LdbCode> query = test::walk_codes(50, 3);
  std::copy_n(train[0].begin() + 10, 20, query.begin() + 15);
  const SequenceDatabase database = make_database(train, 5);
  for (const double threshold : {0.2, 0.8, 0.95}) {
    for (const char* method : {"fastable", "fastable-online", "openable"}) {
      const Threshold rule{{method, 5}, threshold};
      const Result result = query_all(database, make_query(query), {rule}).result;
      CHECK(result.recognitions == slow_recognitions(train, query, 5, threshold));
      CHECK_FALSE(result.recognitions.empty());
    }
  }
}

TEST_CASE("automatic thresholds recognize a revisit and nothing between the training sequences") {
  const std::vector<std::vector<LdbCode>> train = {test::walk_codes(60, 1),
                                                   test::walk_codes(60, 2)};
  std::vector<LdbCode> query = test::walk_codes(50, 3);
  std::copy_n(train[1].begin() + 10, 20, query.begin() + 15);
  const SequenceDatabase database = make_database(train, 10);
  SequenceQuerySettings settings = by_threshold(10);
  const Result result = query_all(database, make_query(query), settings).result;
  CHECK(result.sequences[0].scale == ThresholdScale::bits);
  REQUIRE_FALSE(result.clusters->all.empty());
  for (const Cluster& cluster : result.clusters->all) CHECK(cluster.sequence == 1);
  // The threshold is strict: the closest windows of the training sequences are not recognitions.
  const DescriptorSet first = make_query(train[0]);
  settings.only_sequences = {"b"};
  CHECK(query_all(database, first, settings).result.recognitions.empty());
}

TEST_CASE("a missing window length is computed") {
  const SequenceDatabase database =
      make_database({test::walk_codes(60, 1), test::walk_codes(60, 2)}, 10);
  test::Warnings warnings;
  const SequenceQuerySettings settings = by_threshold(7);
  const auto computed =
      query_all(database, make_query(test::walk_codes(30, 3)), settings, warnings.monitor);
  CHECK(warnings.said.empty());
  const SequenceDatabase other =
      make_database({test::walk_codes(60, 1), test::walk_codes(60, 2)}, 7);
  CHECK(query_all(other, make_query(test::walk_codes(30, 3)), settings)
            .result.sequences[1]
            .threshold == computed.result.sequences[1].threshold);
}

TEST_CASE("training sequences that look different accept every window, with a warning") {
  // Frames of one building differ by about 180 bits, frames of two buildings by about 690.
  std::vector<std::vector<LdbCode>> walks(2);
  for (size_t w = 0; w < 2; ++w) {
    const LdbCode base = test::random_codes(1, 50 + w)[0];
    for (size_t i = 0; i < 40; ++i) {
      LdbCode code = test::random_codes(1, 100 * w + i)[0];
      for (size_t byte = 0; byte < code.size(); ++byte)
        code[byte] = static_cast<uint8_t>(byte % 4 == 0 ? code[byte] : base[byte]);
      walks[w].push_back(code);
    }
  }
  const SequenceDatabase database = make_database(walks, 5);
  const SequenceQuerySettings settings = by_threshold(5);
  const Result result = query_all(database, make_query(walks[0]), settings).result;
  CHECK(result.recognitions.size() == 36 * 36);
  CHECK(*result.sequences[0].threshold > 600);
  CHECK(excess_advice(result) ==
        "t_r accepts 100 % of the window pairs of a: too many to tell places apart");
}

TEST_CASE("an automatic threshold needs another training sequence with a window") {
  const SequenceDatabase alone =
      make_database({test::walk_codes(60, 1, 120), test::walk_codes(9, 2, 120)}, 10);
  const SequenceQuerySettings settings = by_threshold(10);
  CHECK_THROWS_WITH(query_all(alone, make_query(test::walk_codes(50, 3, 120)), settings),
                    "the automatic t_r needs two training sequences with windows of 10 frames "
                    "(c_l). Use a smaller --c-l, or a number for --t-r.");
}

TEST_CASE("only queries with an automatic threshold warn that sequences show one place") {
  std::vector<std::vector<LdbCode>> walks = {test::walk_codes(60, 1, 150),
                                             test::walk_codes(60, 2, 150)};
  std::copy_n(walks[0].begin() + 20, 15, walks[1].begin() + 40);
  const SequenceDatabase database = make_database(walks, 10);
  test::Warnings warnings;
  const DescriptorSet query = make_query(test::walk_codes(50, 3, 150));
  const SequenceQuerySettings settings = by_threshold(10);
  query_all(database, query, settings, warnings.monitor);
  REQUIRE(warnings.said.size() == 1);
  CHECK(warnings.said[0].find("a and b seem to show the same place") == 0);
  warnings.said.clear();
  query_all(database, query, by_margin(10), warnings.monitor);
  query_all(database, query, by_threshold(10, 0.5), warnings.monitor);
  CHECK(warnings.said.empty());
}

TEST_CASE("long sequences are compared only in queries that need it") {
  const std::vector<LdbCode> codes = test::random_codes(1, 1);
  const auto walks = [&](size_t frames) {
    static std::vector<LdbCode> many;
    many.assign(frames, codes[0]);
    return std::vector<DescribedFrames>(3, DescribedFrames{many, {}});
  };
  CHECK_FALSE(is_left_to_queries(walks(30'000)));  // 2.7 billion pairs
  CHECK(is_left_to_queries(walks(40'000)));
  CHECK_FALSE(is_left_to_queries(std::vector<DescribedFrames>(1, walks(100'000)[0])));
}

TEST_CASE("a search can be limited to sequences, which keep their indices in the database") {
  const std::vector<std::vector<LdbCode>> train = {test::walk_codes(30, 1),
                                                   test::walk_codes(30, 2)};
  const SequenceDatabase database = make_database(train, 5);
  SequenceQuerySettings settings = by_threshold(5, 1);
  settings.only_sequences = {"b"};
  const Result result = query_all(database, make_query(train[0]), settings).result;
  CHECK_FALSE(result.recognitions.empty());
  for (const Match& recognition : result.recognitions) CHECK(recognition.sequence == 1);
  CHECK_FALSE(result.sequences[0].searched);
}

TEST_CASE("identical training and query windows: the maximum and all quotients are 0") {
  const std::vector<LdbCode> same(8, test::random_codes(1, 1)[0]);
  const SequenceDatabase database = make_database({same}, 3);
  CHECK(query_all(database, make_query(same), by_threshold(3, 0.1)).result.recognitions.size() ==
        36);
}

TEST_CASE("random cells are distinct, valid, and the same for a seed") {
  FrameDistances distances;
  distances.train_runs = {{0, 10, 0, 0}, {12, 5, 1, 2}};
  distances.query_runs = {{0, 4, 0, 0}, {6, 6, 0, 6}};
  const auto cells = choose_cells(distances, 4, 20, 7);
  CHECK(cells.size() == 20);
  CHECK(cells == choose_cells(distances, 4, 20, 7));
  CHECK(cells != choose_cells(distances, 4, 20, 8));
  for (const Cell& cell : cells) {
    CHECK((cell.query_window == 0 || (cell.query_window >= 6 && cell.query_window <= 8)));
    CHECK((cell.sequence == 0 ? cell.train_window <= 6
                              : cell.train_window == 2 || cell.train_window == 3));
  }
  CHECK(choose_cells(distances, 4, 1000, 7).size() == 9 * 4);
  CHECK(choose_cells(distances, 11, 10, 7).empty());
}

TEST_CASE("a wrong cell is detected") {
  const std::vector<LdbCode> train = test::random_codes(10, 1);
  const std::vector<LdbCode> query = test::random_codes(10, 2);
  const DescribedFrames span{train, {}};
  const uint32_t right = reference_window_distance(train, 3, query, 2, 4);
  const std::vector<Cell> cells = {{2, 0, 3, right}, {2, 0, 4, 1}};
  const auto wrong = wrong_cells(cells, std::span(&span, 1), query, 4, {});
  REQUIRE(wrong.size() == 1);
  CHECK(wrong[0].train_window == 4);
  CHECK(wrong[0].score == reference_window_distance(train, 4, query, 2, 4));
}

TEST_CASE(
    "LSH finds some of the recognitions and best matches of an exact search, and reports its "
    "recall") {
  const std::vector<std::vector<LdbCode>> train = {test::walk_codes(60, 1),
                                                   test::walk_codes(45, 2)};
  const SequenceDatabase database = make_database(train, 5);
  const DescriptorSet query = make_query(train[0]);
  const Threshold bits{{.window_length = 5}, 100, ThresholdScale::bits};
  const Result exact = query_all(database, query, {bits}).result;
  const Result some = query_all(database, query, {Lsh{5, 100}}).result;
  CHECK(method_of(some.settings) == "lsh");
  CHECK(std::includes(
      exact.recognitions.begin(), exact.recognitions.end(), some.recognitions.begin(),
      some.recognitions.end(), [](const Match& a, const Match& b) {
        return std::tie(a.query, a.sequence, a.train) < std::tie(b.query, b.sequence, b.train);
      }));
  CHECK(some.recognitions.size() >= 50);
  CHECK(some.margins.empty());
  REQUIRE(some.clusters);
  REQUIRE(some.recall);
  CHECK(some.recall->windows == 56);
  CHECK(some.recall->recognitions == exact.recognitions.size());
  size_t same = 0;
  for (size_t window = 0; window < 56; ++window)
    same += some.best[window] && some.best[window]->score == exact.best[window]->score;
  CHECK(some.recall->found_best == same);
  CHECK_FALSE(exact.recall);
}

TEST_CASE("a query with other descriptors than the database is refused in one sentence") {
  const SequenceDatabase database = make_database({test::walk_codes(30, 1)}, 4);
  const DescriptorKind other{"other", "", kLdbShape, nullptr};
  DescriptorSet query = make_query(test::walk_codes(20, 2));
  query.descriptors.kind = &other;
  const SequenceQuerySettings settings = by_threshold(4, 0.5);
  const auto plan = [&] { plan_query(prepare(database, settings), query, "q", settings, {}, {}); };
  CHECK(test::error_kind(plan) == ErrorKind::data);
  CHECK(test::error_text(plan) ==
        "the descriptors differ: the database has ldb, the query other. Describe both alike.");
}

TEST_CASE("windows with sums that exceed the file format are refused") {
  DescriptorKind vectors{"vectors", "", {ElementType::int8, 2}, nullptr};
  const std::vector<uint8_t> bytes(200, 1);
  SequenceDatabase database;
  database.sequences = {{{"a", 100}}};
  database.descriptors.kind = &vectors;
  database.descriptors.owned = bytes;
  DescriptorSet query;
  query.descriptors.kind = &vectors;
  query.descriptors.owned = bytes;
  const auto plan = [&] {
    plan_query(prepare(database, by_threshold(32769, 0.5)), query, "q", by_threshold(32769, 0.5),
               {}, {});
  };
  CHECK(test::error_text(plan).starts_with("c_l must be at most 32768 for"));
  const Result result = query_all(database, query, by_threshold(5, 0.5)).result;
  CHECK(result.recognitions.size() == 96 * 96);  // all vectors are equal
}

TEST_CASE("a resampled query repeats the rows of the recording, frame by frame") {
  const std::vector<std::vector<LdbCode>> train = {test::walk_codes(70, 1)};
  const SequenceDatabase database = make_database(train, 1);
  const auto record = [] {
    DescriptorSet recording = make_query(test::walk_codes(50, 3));
    recording.sequence.unreadable = {7, 30};
    return recording;
  };
  const auto best_of = [&](const DescriptorSet& query) {
    return query_all(database, query, by_threshold(1, 0.5)).result;
  };
  const Result plain = best_of(record());
  CHECK(plain.query.selection.is_all());
  for (const SpeedRule& rule : speed_rules()) {
    INFO(rule.name);
    const bool is_long_enough = rule.least_frames <= 50;
    REQUIRE(is_long_enough);
    const Result result = best_of(selected(record(), at_speed(std::string(rule.name), 50, 4)));
    REQUIRE_FALSE(result.query.selection.is_all());
    REQUIRE(result.query.frames == result.query.selection.frames());
    for (size_t k = 0; k < result.query.frames; ++k) {
      const auto& best = result.best[k];
      const auto& expected = plain.best[result.query.selection.sources[k]];
      REQUIRE(best.has_value() == expected.has_value());
      if (!best) continue;
      CHECK(best->train == expected->train);
      CHECK(best->score == expected->score);
      CHECK(best->query == k);
    }
  }
}

TEST_CASE(
    "an empty speed does not change a query, and too short queries are refused with the reason") {
  const DescriptorSet same = selected(make_query(test::walk_codes(3, 3)), at_speed("", 3, 1));
  CHECK(same.sequence.selection.is_all());
  CHECK(ldb_codes(same) == test::walk_codes(3, 3));
  CHECK(test::has(test::error_text([] {
                    selected(make_query(test::walk_codes(3, 3)), at_speed("kidnap", 3, 1));
                  }),
                  "41 frames"));
  const DescriptorSet one = selected(make_query(test::walk_codes(1, 3)), at_speed("0.5", 1, 1));
  CHECK(one.sequence.frames == 2);
  CHECK(one.sequence.frame_names == std::vector<std::string>{"0", "0"});
}
