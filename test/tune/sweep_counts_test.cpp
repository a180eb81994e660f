// Counts of sweeps, compared with single queries and with random chance.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/random.h"
#include "evaluate/outcomes.h"
#include "queries.h"
#include "support.h"
#include "tune/sweep.h"

using namespace vpr;
using test::random_words;

namespace {

/// A sequence of 20 views, and a place with three views.
FabmapDatabase make_database(RandomEngine& engine) {
  FabmapDatabase database;
  std::vector<WordSet> pretrain;
  for (int f = 0; f < 40; ++f) pretrain.push_back(random_words(100, 3, engine));
  database.tree = train_chow_liu(pretrain, 100, {});
  for (const WordSet& frame : pretrain) database.pretrain.add(frame);
  std::vector<WordSet> walk;
  for (int f = 0; f < 20; ++f) walk.push_back(random_words(100, 3, engine));
  add_group(database, {{"walk", 20}}, walk);
  add_group(
      database, {{"lift", 3}, true},
      std::vector<WordSet>{walk[3], random_words(100, 3, engine), random_words(100, 3, engine)});
  index_views(database);
  return database;
}

/// The sequence again with a few other words per frame. Frame 7 cannot be decoded.
SequenceWords make_query(const FabmapDatabase& database, RandomEngine& engine) {
  SequenceWords query;
  for (size_t f = 0; f < 20; ++f) {
    WordSet words;
    for (const uint32_t word : database.views.view(f))
      if (uniform_below(engine, 6) != 0) words.push_back(word);
    query.words.push_back(words);
  }
  query.words[7].clear();
  query.sequence = {"q", 20, {}, {7}};
  return query;
}

/// Each query frame shows its own view, but frame 5 shows none, and the pair of frame 9 is ignored.
LabeledWords labeled(const SequenceWords& query, const test::TemporaryFolder& folder) {
  std::string pairs = "query,reference,label\n";
  for (size_t f = 0; f < query.words.size(); ++f)
    if (f != 5) pairs += fmt::format("{},{},{}\n", f, f, f == 9 ? "ignore" : "same");
  test::write_text(folder / "pairs.csv", pairs);
  EvaluationSettings by;
  by.ground_truth = {"pairs", folder / "pairs.csv"};
  return {"q", query, by};
}

/// Ten windows of c_l frames, with correct and incorrect recognitions in the given windows.
SweepIntervals intervals_of(size_t length, const std::vector<uint32_t>& right,
                            const std::vector<uint32_t>& wrong, size_t windows = 10) {
  const size_t frames = windows + length - 1;
  Result result = test::make_result(frames, length, 100);
  const GroundTruth truth = test::aligned_truth(frames, frames);
  for (const uint32_t window : right) result.recognitions.push_back({window, 0, window, 0, 1});
  for (const uint32_t window : wrong) result.recognitions.push_back({window, 0, window + 50, 0, 1});
  return count_intervals(result, truth, 1);
}

}  // namespace

TEST_CASE("a sweep of FAB-MAP equals single queries, cell by cell") {
  RandomEngine engine(4);
  const FabmapDatabase database = make_database(engine);
  const test::TemporaryFolder folder;
  const LabeledWords query = labeled(make_query(database, engine), folder);
  const Grid grid{{1, 2, 4}, {0.99, 0.9, 0.5, 0.01}};
  const auto cells = sweep_fabmap(database, query, {}, grid, 1, {}).cells;
  REQUIRE(cells.size() == 12);
  std::set<uint64_t> different;
  for (size_t c = 0; c < cells.size(); ++c) {
    const FabmapQuerySettings settings = settings_at(grid, c, FabmapQuerySettings{});
    const Result result =
        query_fabmap(database, query.frames, query.name, settings, 1, {}, {}).result;
    const GroundTruth truth = whole_truth_of(query.by, scope_of(result), {});
    const Counts alone = count_recognitions(result, truth);
    INFO("c_w " << settings.window << ", t_p " << settings.place_threshold);
    CHECK(cells[c].window == settings.window);
    CHECK(cells[c].threshold == settings.place_threshold);
    CHECK_FALSE(cells[c].scale);
    CHECK(cells[c].counts.recognitions.correct == alone.recognitions.correct);
    CHECK(cells[c].counts.recognitions.incorrect == alone.recognitions.incorrect);
    CHECK(cells[c].counts.recognitions.ignored == alone.recognitions.ignored);
    CHECK(cells[c].counts.distinct == alone.distinct);
    CHECK(cells[c].counts.best_match == best_match_counts(outcomes_of(result, truth)));
    CHECK_FALSE(cells[c].counts.clusters);
    different.insert(alone.recognitions.correct);
  }
  CHECK(different.size() >= 3);
  CHECK(cells[3].counts.recognitions.incorrect > 0);
  CHECK(cells[3].counts.recognitions.ignored > 0);
}

TEST_CASE("an interval is the central 95% of random counts") {
  // One of ten windows, drawn one by one, has recognitions: it is drawn Binomial(10, 0.1) times, at
  // most 2 times in 93.0% of all cases and at most 3 times in 98.7%.
  const SweepIntervals single = intervals_of(1, {4}, {7, 7});
  CHECK(single.block == 1);
  CHECK((single.correct_recognitions.low == 0 && single.correct_recognitions.high == 3));
  CHECK((single.incorrect_recognitions.low == 0 && single.incorrect_recognitions.high == 6));
  // Half of them have one: Binomial(10, 0.5), below 2 in 1.1%, below 3 in 5.5%.
  const SweepIntervals half = intervals_of(1, {0, 2, 4, 6, 8}, {});
  CHECK((half.correct_recognitions.low == 2 && half.correct_recognitions.high == 8));
  CHECK((half.incorrect_recognitions.low == 0 && half.incorrect_recognitions.high == 0));
  // Two blocks of two of four windows, each with the recognition in two of four cases: once or
  // twice, while four single windows have it up to three times.
  CHECK(intervals_of(2, {0}, {}, 4).correct_recognitions.high == 2);
  CHECK(intervals_of(1, {0}, {}, 4).correct_recognitions.high == 3);
  // A single block: for any start, every window is drawn once.
  const SweepIntervals whole = intervals_of(10, {0, 3, 4}, {9});
  CHECK((whole.correct_recognitions.low == 3 && whole.correct_recognitions.high == 3));
  CHECK((whole.incorrect_recognitions.low == 1 && whole.incorrect_recognitions.high == 1));
}
