// Matrices, descriptors, lists and ground truth as input and output.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/random.h"
#include "world.h"

using namespace vpr;
using namespace vpr::test;

namespace {

RunOutcome evaluate(const std::string& words, const std::string& more = "") {
  return run("vpr-eval " + words + " " + more);
}

/// Distances of `queries` frames to `references` frames; query i is closest to reference
/// step * i + off.
std::string distances(size_t queries, size_t references, size_t step = 1, size_t off = 0) {
  RandomEngine engine(7);
  std::vector<float> values;
  for (size_t q = 0; q < queries; ++q)
    for (size_t r = 0; r < references; ++r)
      values.push_back(static_cast<float>(uniform_unit(engine) + (r == step * q + off ? 0 : 2)));
  write_array("d.npy", values, {queries, references});
  return "d.npy";
}

constexpr size_t kFrames = 20;

// Similarities of 20 queries to 20 references: the correct one is often among the best.
void make_scores() {
  RandomEngine engine(5);
  std::vector<double> scores;
  std::string queries;
  std::string references;
  for (size_t j = 0; j < kFrames; ++j) {
    for (size_t i = 0; i < kFrames; ++i)
      scores.push_back(uniform_unit(engine) + (i == j ? 0.6 : 0));
    queries += fmt::format("query/{:02}.jpg\n", j);
    references += fmt::format("db/{:02}.jpg\n", j);
  }
  write_array("s.npy", scores, {kFrames, kFrames});
  write_text("q.txt", queries);
  write_text("db.txt", references);
}

const std::string kNamed = "--query q.txt --train db.txt";
const std::string kTruth = "--ground-truth aligned --tolerance 0 --json";

}  // namespace

TEST_CASE("rows of scores are windows of the length given by the query") {
  const std::string words = "matrix " + distances(20, 20) + " --distance --ground-truth aligned";
  const auto windows_of = [&](const std::string& length, const std::string& more) {
    return evaluate(words + " --rows-are-windows-of " + length + " --json", more);
  };
  CHECK(printed_json(windows_of("5", ""))["localization"]["frames"] == 24);
  CHECK(printed_json(windows_of("5", "--query-frames 24"))["settings"]["window"] == 5);
  CHECK(printed_json(windows_of("30", "--query-frames 49"))["localization"]["frames"] == 49);
}

TEST_CASE("a shifted ground truth is distinguished from a failing method") {
  const auto warning = [&](const std::string& scores, const std::string& more) {
    return ok(evaluate("matrix " + scores + " --distance --ground-truth aligned", more)).err;
  };
  const std::string off = distances(20, 22, 1, 2);
  CHECK(warning(off, "") ==
        "warning: all 20 best matches are within 2 frames of the truth. If that is the same place, "
        "use --tolerance 2\n");
  CHECK(warning(off, "--tolerance 2").empty());
  const std::string fast = distances(20, 40, 2);
  CHECK(warning(fast, "--tolerance 1") ==
        "warning: the query has 20 frames and the training sequence 40: --train-step 2?\n");
  CHECK(warning(fast, "--train-step 2").empty());
  CHECK(warning(distances(20, 40), "").empty());  // correct for any lengths
}

TEST_CASE("scores of the wrong order are detected by their recall") {
  const std::string scores = distances(20, 20);
  const auto outcome = evaluate("matrix " + scores + " --similarity --ground-truth aligned");
  CHECK(has(outcome.err, "d.npy: R@1 is "));
  CHECK(has(outcome.err, " % with --similarity and 100.0 % with --distance\n"));
  CHECK(evaluate("matrix " + scores + " --distance --ground-truth aligned").err.empty());
}

TEST_CASE("pairs name frames by number or by file") {
  run_ok("vpr-query $db --query $back --c-l 10 -o r.json --quiet");
  std::string named = "query,sequence,reference\n";
  std::string stems = named;
  std::string numbers = named;
  for (int i = 0; i < 12; ++i) {
    const std::string query = images_of(world().walk("back")).at(size_t(i));
    const std::string reference = images_of(world().walk("one")).at(size_t(20 - i));
    named += fmt::format("{},one,{}\n", query, reference);
    stems += fmt::format("x/{},one,{}\n", query, reference);
    numbers += fmt::format("{},one,{}\n", i, 20 - i);
  }
  write_text("named.csv", named);
  write_text("stems.csv", stems);
  write_text("numbers.csv", numbers);
  const auto counts = [&](const std::string& name, const std::string& more = "") {
    return printed_json(
        evaluate("r.json --ground-truth " + name + " --json --quiet " + more))["best_match"];
  };
  const Json expected = counts("numbers.csv");
  CHECK(expected["without_match"] != expected["frames"]);
  CHECK(counts("named.csv") == expected);  // the query and the database of the run
  CHECK(counts("stems.csv") == expected);
  CHECK(counts("named.csv", "--query $back --train $one --train $two") == expected);
}

TEST_CASE("training images of several sizes cause a warning") {
  write_walk("walk", 6, 0);
  write_image("walk/04.png", 4, 50);
  CHECK(has(run_ok("vpr-train fastable --train walk --c-l 2 -o w.vprdb").err,
            "walk: 1 of 6 images are not 40 x 30 like 00.png; the first is 04.png, 50 x 30"));
}

TEST_CASE("a result is evaluated with its own query of a data set with several queries") {
  run_ok("vpr-query $db --dataset $dataset --c-l 10 --t-r 0.3 -o r.json");
  const auto counts = [&](const std::string& dataset) {
    return printed_json(evaluate("r.json --dataset " + dataset + " --json"))["counts"];
  };
  CHECK(counts(world().walk("dataset.json")) == counts(world().dataset()));
}

TEST_CASE("written pairs can be read back, with the recall of the scores") {
  start_with(make_scores);
  const std::string source = "matrix s.npy --similarity";
  const Json scores = printed_json(evaluate(source, kTruth));
  const auto written = ok(evaluate(source, "--top-k 10 --pairs pairs.txt " + kNamed));
  CHECK(has(written.out, "200 pairs"));
  CHECK(read_text("pairs.txt").starts_with("query/00.jpg db/"));
  const Json pairs = printed_json(evaluate("matrix pairs.txt " + kNamed, kTruth));
  for (const std::string k : {"1", "5", "10"})
    CHECK(pairs["metrics"]["recall_at"][k] == scores["metrics"]["recall_at"][k]);
  CHECK(scores["metrics"]["recall_at"]["1"].get<double>() > 0.3);
  CHECK(scores["metrics"]["recall_at"]["1"].get<double>() < 1);
  // Together with a report, and with numbers as names.
  ok(evaluate(source, "--ground-truth aligned --pairs numbers.txt --top-k 1"));
  CHECK(printed_json(evaluate("matrix numbers.txt", kTruth))["metrics"]["recall_at"]["1"] ==
        scores["metrics"]["recall_at"]["1"]);
}

TEST_CASE("pairs of a result are its best matches, or those of its matrix") {
  run_ok("vpr-query $db --query $back --c-l 5 --t-r 0.5 -o r.json --save-matrix m.npy");
  const std::string names = "--query $back --train $one --train $two";
  ok(evaluate("r.json --pairs best.txt", names));
  ok(evaluate("r.json --matrix m.npy --top-k 3 --pairs three.txt", names));
  const std::string one = read_text("best.txt");
  const std::string all = read_text("three.txt");
  CHECK(3 * std::count(one.begin(), one.end(), '\n') == std::count(all.begin(), all.end(), '\n'));
  CHECK(all.starts_with(one.substr(0, one.find('\n'))));
  CHECK(one.starts_with(world().walk("back")));
}
