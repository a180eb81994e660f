// Trials of settings, and the choice among them.
#include "tune/trials.h"

#include <catch2/catch.hpp>

#include "examples.h"
#include "query/prepare.h"

using namespace vpr;

namespace {

FrameCounts path(size_t correct, size_t incorrect, size_t incorrect_pairs = 0) {
  FrameCounts counts;
  counts.path.frames = 100;
  counts.path.correct = correct;
  counts.path.incorrect = incorrect;
  counts.pairs.incorrect = incorrect_pairs;
  return counts;
}

std::optional<size_t> chosen(const std::vector<FrameCounts>& paths, uint64_t max_incorrect = 0) {
  Trials trials;
  trials.max_incorrect = max_incorrect;
  for (const FrameCounts& one : paths) trials.all.push_back({"", {}, false, {one}, 0});
  choose(trials);
  return trials.chosen;
}

}  // namespace

TEST_CASE("the best counts are the most correct frames with few enough incorrect ones") {
  const std::vector<FrameCounts> paths = {path(10, 0), path(40, 2), path(30, 1), path(30, 0)};
  CHECK(best_counts(paths, 0) == 3);
  CHECK(best_counts(paths, 1) == 3);
  CHECK(best_counts(paths, 2) == 1);
  // Incorrect pairs next to a correct best match are errors as well.
  CHECK(best_counts(std::vector{path(90, 0, 400), path(10, 0)}, 0) == 1);
  // Without such counts: the fewest incorrect frames, then the most correct ones.
  CHECK(best_counts(std::vector{path(50, 9), path(4, 3), path(5, 3)}, 2) == 2);
}

TEST_CASE("of equal counts the first is chosen, and none without a correct frame") {
  CHECK(chosen({path(20, 0), path(20, 0)}) == 0u);
  CHECK(chosen({path(20, 1), path(21, 0)}, 1) == 1u);
  CHECK(chosen({path(20, 1), path(20, 0)}, 1) == 1u);
  CHECK_FALSE(chosen({path(0, 0), path(90, 1)}));
  CHECK_FALSE(chosen({path(0, 0), path(0, 5)}));
  CHECK(chosen({path(0, 0), path(90, 1)}, 1) == 1u);
}

TEST_CASE("a threshold that fits the ground truth is chosen only if nothing else is") {
  Trials trials;
  trials.all = {{"", {}, false, {path(20, 0)}, 0}, {"", {}, true, {path(90, 0)}, 0}};
  choose(trials);
  CHECK(trials.chosen == 0u);
  trials.all[0].counts = {path(0, 0)};
  choose(trials);
  CHECK(trials.chosen == 1u);
  trials.all[0].counts = {path(20, 1)};
  choose(trials);
  CHECK(trials.chosen == 1u);
}

TEST_CASE("totals add the queries, and have the latest first recognition") {
  Trial trial;
  trial.counts = {path(3, 1), path(4, 0)};
  trial.counts[0].path.first_recognition_frames = 7;
  CHECK(trial.total().path.frames == 200);
  CHECK(trial.total().path.correct == 7);
  CHECK(trial.total().path.incorrect == 1);
  CHECK_FALSE(trial.total().path.first_recognition_frames);
  trial.counts[1].path.first_recognition_frames = 2;
  CHECK(trial.total().path.first_recognition_frames == 7u);
}

TEST_CASE(
    "a query at twice the speed is recognized by the filter, and short ones without windows") {
  const test::Example walk = test::make_example({160}, 0, 3);
  SequenceDatabase database = test::make_database({walk.train[0]});
  ensure_statistics(database, {});
  QueryResources resources;
  const auto trials_of = [&](size_t frames, size_t step) {
    std::vector<LdbCode> codes;
    for (size_t f = 0; f < frames; ++f) codes.push_back(walk.train[0][f * step]);
    std::vector<LabeledQuery> queries;
    EvaluationSettings by;
    by.ground_truth = parse_ground_truth_argument("aligned", 2);
    by.ground_truth->options.train_step = static_cast<double>(step);
    queries.push_back({"q", test::make_query(codes), by});
    return try_sequences(database, queries, {}, 0, resources, {});
  };
  const Trials twice = trials_of(80, 2);
  REQUIRE(twice.all.size() == 3);
  CHECK(twice.chosen.has_value());
  CHECK(twice.all[0].name == "filter");
  CHECK(twice.all[0].counts[0].path.correct > twice.all[1].counts[0].path.correct);
  CHECK(trials_of(9, 1).all.size() == 1);
}
