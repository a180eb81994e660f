// A sweep's cells equal single queries.
#include "tune/sweep.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/error.h"
#include "base/random.h"
#include "examples.h"
#include "queries.h"
#include "query/prepare.h"
#include "support.h"

using namespace vpr;

namespace {

SequenceDatabase make_database() {
  SequenceDatabase database = test::make_database(
      {test::walk_codes(90, 10, 40), test::walk_codes(90, 11, 40), test::walk_codes(90, 12, 40)});
  database.sequences[1].sequence.unreadable = {40};
  return database;
}

// Frames 10 to 89 of the first sequence, with changed bits.
DescriptorSet make_query(size_t changed_bits) {
  std::vector<LdbCode> codes = test::walk_codes(90, 10, 40);
  codes.erase(codes.begin(), codes.begin() + 10);
  RandomEngine engine(5);
  for (LdbCode& code : codes)
    for (size_t i = 0; i < changed_bits; ++i) {
      uint8_t& byte = code[uniform_below(engine, 173)];
      byte = static_cast<uint8_t>(byte ^ 1U << uniform_below(engine, 8));
    }
  DescriptorSet query = test::make_query(codes);
  query.sequence.unreadable = {30};
  return query;
}

// Query frame f shows frame f + 10 of the first sequence; every ninth pair is ignored.
LabeledQuery labeled(const DescriptorSet& query) {
  static const test::TemporaryFolder folder;
  std::string pairs = "query,sequence,reference,label\n";
  for (int f = 0; f < 80; ++f)
    pairs += fmt::format("{},a,{},{}\n", f, f + 10, f % 9 == 0 ? "ignore" : "same");
  test::write_text(folder / "pairs.csv", pairs);
  EvaluationSettings by;
  by.ground_truth = {"pairs", folder / "pairs.csv", 2};
  return {"q", query, by};
}

// Every cell has the counts of a single query with its settings.
Sweep check_sweep(const SequenceDatabase& database, const DescriptorSet& query,
                  const SequenceQuerySettings& base, const Grid& grid) {
  const LabeledQuery walk = labeled(query);
  const Sweep sweep = sweep_sequences(database, walk, base, grid, {}, {});
  REQUIRE(sweep.cells.size() == grid.windows.size() * grid.thresholds.size());
  size_t recognitions = 0;
  for (size_t c = 0; c < sweep.cells.size(); ++c) {
    const CellCounts& cell = sweep.cells[c];
    const SequenceQuerySettings settings = settings_at(grid, c, base);
    const Result result = test::query_result(database, query, settings);
    const GroundTruth truth = whole_truth_of(walk.by, scope_of(result), {});
    const Counts alone = count_recognitions(result, truth);
    INFO("c_l " << window_length_of(settings.rule) << ", cell " << c);
    CHECK(cell.window == window_length_of(settings.rule));
    CHECK(cell.threshold == grid.thresholds[c % grid.thresholds.size()]);
    CHECK(cell.counts.recognitions == alone.recognitions);
    CHECK(cell.counts.recognitions_by_place == alone.recognitions_by_place);
    CHECK(cell.counts.recognitions_by_place->all() == result.recognitions.size());
    CHECK(cell.counts.clusters == alone.clusters);
    CHECK(cell.counts.distinct == alone.distinct);
    CHECK(cell.counts.best_match == best_match_counts(outcomes_of(result, truth)));
    recognitions += alone.recognitions.correct;
  }
  CHECK(recognitions > 0);
  return sweep;
}

}  // namespace

TEST_CASE("a sweep of thresholds equals single queries, cell by cell") {
  SequenceDatabase database = make_database();
  const DescriptorSet query = make_query(200);
  Threshold base;
  check_sweep(database, query, {base}, {{1, 20, 5}, {0.3, 0.6, 0.9, 0, std::nullopt}});
  base.scale = ThresholdScale::bits;
  check_sweep(database, query, {base}, {{1, 20, 5}, {250, 400, 650, 0, std::nullopt}});
  ensure_statistics(database, {});
  const SequenceQuerySettings scored{Threshold{{.score = Score::zscore}}};
  const Sweep sweep = check_sweep(database, query, scored, {{5, 1, 12}, {-1.0, -4.0, -2.0}});
  CHECK(sweep.cells[0].scale == ThresholdScale::mean_z);
}

TEST_CASE("a sweep gives each warning of its settings once") {
  SequenceDatabase database = make_database();
  DescriptorSet query = test::make_query(test::walk_codes(90, 10, 40));
  query.sequence.unreadable = {30};
  const QueryResources resources;
  test::Warnings warnings;
  // The second training sequence has runs of at most 49 frames.
  sweep_sequences(database, labeled(query), {}, {{5, 50, 55}, {0.3, 0.6, std::nullopt}}, resources,
                  warnings.monitor);
  const auto times = [&](const std::string& words) {
    return std::ranges::count_if(warnings.said, [&](const std::string& sentence) {
      return sentence.find(words) != std::string::npos;
    });
  };
  CHECK(times("b: cannot be recognized without 50 consecutive") == 1);
  CHECK(times("b: cannot be recognized without 55 consecutive") == 1);
  CHECK(times("cannot be decoded") == 1);
}

TEST_CASE("the recognitions of all window lengths share the memory limit") {
  const SequenceDatabase database = make_database();
  DescriptorSet query = test::make_query(test::walk_codes(90, 10, 40));
  QueryResources resources;
  Threshold bits;
  bits.scale = ThresholdScale::bits;
  const auto run = [&](std::vector<uint64_t> lengths, size_t memory) {
    resources.memory_limit = memory;
    return test::error_kind([&] {
      sweep_sequences(database, labeled(query), {bits}, {std::move(lengths), {1500.0}}, resources,
                      {});
    });
  };
  const size_t enough = 64 * size_t{90} * 270;
  CHECK(!run({1}, enough));
  CHECK(run({1, 2}, enough) == ErrorKind::usage);
  CHECK(!run({1, 2}, 2 * enough));
}

TEST_CASE("intervals of constant counts are the counts") {
  Result result = test::make_result(12, 3, 30);
  const GroundTruth truth = test::aligned_truth(12, 12);
  // Every window has a correct and two incorrect recognitions.
  for (uint32_t window = 0; window < 10; ++window)
    for (const uint32_t train : {window, window + 5, window + 9})
      result.recognitions.push_back({window, 0, train, 0, 1});
  result.clusters.emplace();
  result.clusters->all = {{0, 3, 0, 9, 3, 0, 9, 10, 1}};
  const SweepIntervals found = count_intervals(result, truth, 7);
  CHECK(found.block == 3);
  CHECK((found.correct_recognitions.low == 10 && found.correct_recognitions.high == 10));
  CHECK((found.incorrect_recognitions.low == 20 && found.incorrect_recognitions.high == 20));
  CHECK(found.correct_clusters.high >= 1);
  CHECK((found.incorrect_clusters.low == 0 && found.incorrect_clusters.high == 0));
  // For single frames, blocks have c_w frames, but at least 8.
  FabmapQuerySettings fabmap;
  result.clusters.reset();
  result.settings = fabmap;
  result.query_windows = result.query.frames;
  CHECK(count_intervals(result, truth, 7).block == 8);
  fabmap.window = 9;
  result.settings = fabmap;
  CHECK(count_intervals(result, truth, 7).block == 9);
  fabmap.window = 100;
  result.settings = fabmap;
  CHECK(count_intervals(result, truth, 7).block == 12);
}

TEST_CASE("a FAB-MAP threshold is a probability") {
  FabmapDatabase database;
  CHECK(test::error_kind([&] {
          sweep_fabmap(database, {"q", {}, {}}, {}, {{1}, {1.5}}, 1, {});
        }) == ErrorKind::usage);
}

TEST_CASE("a sweep by margin equals single queries by margin") {
  const Sweep sweep = check_sweep(make_database(), make_query(0), {Margin{}},
                                  {{1, 12}, {0, 30, 90, 300, std::nullopt}});
  CHECK(sweep.threshold_symbol == "margin");
  CHECK(sweep.threshold_order == ScoreOrder::similarity);
  CHECK_FALSE(sweep.cells[0].scale);
  // A smaller margin accepts more, also without the places.
  for (const size_t c : {0, 1, 2, 5, 6, 7}) {
    CHECK(sweep.cells[c].unknown_place >= sweep.cells[c + 1].unknown_place);
    CHECK(sweep.cells[c].unknown_place.has_value());
  }
  CHECK(sweep.cells[0].unknown_place > 0u);
  CHECK(!sweep.cells[4].unknown_place);
  CHECK(sweep.cells[0].counts.recognitions.correct > sweep.cells[3].counts.recognitions.correct);
  CHECK(sweep.cells[1].counts.recognitions.correct > 0);
}
