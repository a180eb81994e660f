// Queries by margin: every margin compared with its definition, and the resulting recognitions.
#include <algorithm>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "examples.h"
#include "queries.h"
#include "query/prepare.h"
#include "query/run_query.h"
#include "reference/reference.h"
#include "support.h"

using namespace vpr;
using test::by_margin;
using test::make_query;
using test::query_result;

namespace {

// Two sequences and a noisy query through part of the first one.
struct MarginWalks {
  std::vector<std::vector<LdbCode>> train = {test::walk_codes(90, 1), test::walk_codes(70, 2)};
  std::vector<LdbCode> query = test::walk_codes(60, 3);
  MarginWalks() { std::copy_n(train[0].begin() + 20, 30, query.begin() + 15); }
};

// The definition, from all distances of a query window; `width` of every sequence.
std::optional<double> slow_margin(const MarginWalks& walks, size_t window, size_t length,
                                  size_t width) {
  std::optional<Match> best;
  std::vector<Match> row;
  for (size_t s = 0; s < walks.train.size(); ++s)
    for (size_t i = 0; i + length <= walks.train[s].size(); ++i)
      row.push_back(
          {uint32_t(window), uint32_t(s), uint32_t(i), 0,
           double(reference_window_distance(DescriptorRows(walks.train[s]), i,
                                            DescriptorRows(walks.query), window, length))});
  for (const Match& match : row)
    if (!best || match.score < best->score) best = match;
  std::optional<double> runner_up;
  for (const Match& match : row) {
    const size_t apart = std::max(match.train, best->train) - std::min(match.train, best->train);
    if (match.sequence == best->sequence && apart <= width) continue;
    if (!runner_up || match.score < *runner_up) runner_up = match.score;
  }
  return runner_up ? std::optional(*runner_up - best->score) : std::nullopt;
}

}  // namespace

TEST_CASE("every exact method gives each query window its margin, for any decision") {
  const MarginWalks walks;
  const SequenceDatabase database = test::make_database(walks.train);
  const DescriptorSet query = make_query(walks.query);
  for (const char* method : {"fastable", "fastable-online", "openable"}) {
    for (const size_t width : {0, 4, 1000}) {
      const SequenceQuerySettings settings{Threshold{{method, 6, Score::raw, width}}};
      const ThreadLimit limit(1 + width % 3);
      const Result result = query_result(database, query, settings);
      REQUIRE(result.margins.size() == 55);
      for (size_t window = 0; window < 55; ++window) {
        INFO(method << " " << width << " " << window);
        CHECK(result.margins[window] == slow_margin(walks, window, 6, width));
      }
    }
  }
}

TEST_CASE("by margin, only a place that is seen again is recognized") {
  const MarginWalks walks;
  const SequenceDatabase database = test::make_database(walks.train);
  for (const std::optional<double> margin : {std::optional<double>(), std::optional(60.0)}) {
    const Result result = query_result(database, make_query(walks.query), by_margin(10, margin));
    CHECK(result.recognitions.size() >= 20);
    for (const Match& recognition : result.recognitions) {
      CHECK(recognition.sequence == 0);
      CHECK(std::abs(int(recognition.train) - int(recognition.query) - 5) <= 1);
    }
    REQUIRE(result.clusters->all.size() == 1);
    CHECK(result.clusters->all[0].recognitions == result.recognitions.size());
  }
}

TEST_CASE("two sequences of one place do not reduce each other's margin") {
  const MarginWalks walks;
  const DescriptorSet query = make_query(walks.query);
  const auto recognitions = [&](const SequenceDatabase& database,
                                std::vector<std::string> same_place) {
    Margin rule{{.window_length = 10}, 60.0};
    rule.windows.same_place = std::move(same_place);
    return query_result(database, query, {rule}).recognitions;
  };
  const std::vector<Match> once = recognitions(test::make_database(walks.train), {});
  REQUIRE(once.size() >= 20);
  const SequenceDatabase twice =
      test::make_database({walks.train[0], walks.train[1], walks.train[0]});
  CHECK(recognitions(twice, {}) == once);
  CHECK(recognitions(twice, {"a=c"}) == once);
  CHECK(recognitions(twice, {"none"}).empty());
  CHECK(recognitions(twice, {"a=b"}).empty());
  CHECK(test::error_kind([&] { recognitions(twice, {"a=d"}); }) == ErrorKind::usage);
  CHECK(test::error_kind([&] { recognitions(twice, {"a=a"}); }) == ErrorKind::usage);
}

TEST_CASE("stored exclusion radii and overlaps have the results of computed ones") {
  const MarginWalks walks;
  const std::vector<std::vector<LdbCode>> train = {walks.train[0], walks.train[1], walks.train[0]};
  const SequenceDatabase old = test::make_database(train);
  SequenceDatabase database = test::make_database(train);
  ensure_exclusion_zones(database, {});
  CHECK(database.overlapping_sequences == std::vector<std::pair<size_t, size_t>>{{0, 2}});
  const SequenceQuerySettings settings = by_margin(10, std::nullopt);
  const DescriptorSet query = make_query(walks.query);
  const Result result = query_result(database, query, settings);
  const Result derived = query_result(old, query, settings);
  CHECK(result.recognitions == derived.recognitions);
  CHECK(result.margins == derived.margins);
  CHECK(result.sequences[1].margin == derived.sequences[1].margin);
  // The query uses the stored value.
  database.overlapping_sequences->clear();
  CHECK(query_result(database, query, settings).recognitions.empty());
}

TEST_CASE(
    "without windows outside the exclusion zone there is no margin and no recognition by margin") {
  const MarginWalks walks;
  const SequenceQuerySettings settings{
      Margin{{.window_length = 10, .exclusion_frames = 10'000}, 0.0}};
  const SequenceDatabase one = test::make_database({walks.train[0]});
  Result result = query_result(one, make_query(walks.query), settings);
  CHECK(result.recognitions.empty());
  CHECK(std::none_of(result.margins.begin(), result.margins.end(),
                     [](const auto& margin) { return margin.has_value(); }));
  // A training sequence of one frame, and a query of one.
  const SequenceDatabase frame = test::make_database({{walks.train[0][0]}});
  result = query_result(frame, make_query({walks.query[0]}), by_margin(1, std::nullopt));
  CHECK(result.recognitions.empty());
  CHECK(result.margins == std::vector<std::optional<double>>{std::nullopt});
}

TEST_CASE("unreadable frames have no margin") {
  const MarginWalks walks;
  DescriptorSet query = make_query(walks.query);
  query.sequence.unreadable = {30};
  const Result result =
      query_result(test::make_database(walks.train), query, by_margin(5, std::nullopt));
  for (size_t window = 0; window < result.margins.size(); ++window)
    CHECK(result.margins[window].has_value() == (window < 26 || window > 30));
}

TEST_CASE("by margin, recognitions are best matches that beat the runner-up by the margin") {
  QueryPlan plan;
  plan.match.window_length = 5;
  plan.result.settings = by_margin(5, std::nullopt);
  plan.decision = ByMargin{};
  plan.result.sequences.resize(2);
  plan.result.sequences[0].margin = plan.result.sequences[1].margin = 2;
  const RecognitionScanResult found{
      {{0, 0, 0, 1}},
      {Cell{0, 0, 7, 40}, Cell{1, 1, 8, 30}, std::nullopt, Cell{3, 0, 9, 20}, Cell{4, 1, 9, 20}}};
  const Result result = make_result(plan, found, {10, 9, std::nullopt, std::nullopt, 11});
  CHECK(result.recognitions == std::vector<Match>{{0, 0, 7, 0, 40}, {4, 1, 9, 0, 20}});
  CHECK(frame_margin(result, 0) == 2);
  CHECK(frame_margin(result, 3) == std::nullopt);
}
