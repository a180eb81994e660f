// Matrices, descriptors, lists and ground truth as input and output.
#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

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

// The frame distances of the rendered sequences, and multiples of 1/1024 below 2 as similarities
// with references first.
void make_matrix() {
  run_ok("vpr-query $db --query $back --c-l 1 --t-r 0.1 --save-matrix s.npy -o s.json");
  const NpyArray array("s.npy");
  const auto distances = array.values<int32_t>(2);
  const size_t queries = array.shape()[0];
  const size_t references = array.shape()[1];
  std::vector<double> similarities(distances.size());
  for (size_t j = 0; j < queries; ++j)
    for (size_t i = 0; i < references; ++i)
      similarities[i * queries + j] = 2 - distances[j * references + i] / 1024.0;
  write_array("turned.npy", similarities, {references, queries});
}

// `words`: the matrix with its order, and further flags. The sequences are those of the database.
RunOutcome query_matrix(const std::string& words) {
  const size_t one = images_of(world().walk("one")).size();
  const size_t two = images_of(world().walk("two")).size();
  return run(fmt::format("vpr-query matrix {} --train-sequence one=0:{} --train-sequence two={}:{}",
                         words, one, one, one + two));
}

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
  CHECK(warning(off, "") == "warning: all 20 best matches are within 2 frames of the truth\n");
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

TEST_CASE("windows of a matrix of frame distances equal those of the database") {
  start_with(make_matrix);
  write_text("openable.json", R"({"method": "openable"})");
  write_text("online.json", R"({"method": "fastable-online"})");
  for (const std::string words : {"--t-r 0.65", "--t-r 0.7 --config openable.json",
                                  "--t-r 150 --t-r-scale bits --config online.json", "--t-r 0.8",
                                  "--t-r 0.65 --only-sequence two", "--t-r 0.65 --rates 1/2,1,2",
                                  "--decide margin --margin 20"}) {
    INFO(words);
    const std::string common =
        words + " --c-l 10 --exclusion-frames 4 --same-place none --force -o ";
    run_ok("vpr-query $db --query $back " + common + "coded.json");
    ok(query_matrix("s.npy --distance " + common + "read.json"));
    for (const char* kind :
         {"recognitions", "recognition_scores", "best", "best_scores", "margins"})
      CHECK(read_text(fmt::format("coded.{}.npy", kind)) ==
            read_text(fmt::format("read.{}.npy", kind)));
    const Json json = file_json("read.json");
    CHECK(json["scores"] ==
          Json{{"kind", "distance"}, {"best", 0.0}, {"unit", 1.0}, {"is_exact", true}});
    CHECK(json["clusters"] == file_json("coded.json")["clusters"]);
  }
  const Json rounded =
      printed_json(query_matrix("turned.npy --similarity --train-first --c-l 7 --t-r 0.6 --json"));
  CHECK(rounded["scores"]["kind"] == "similarity");
  CHECK_FALSE(rounded["scores"]["is_exact"].get<bool>());
}

TEST_CASE("similarities have the best matches of distances, and are evaluated like any result") {
  start_with(make_matrix);
  for (const std::string score : {"raw", "zscore", "zscore-offline"}) {
    INFO(score);
    const auto rate = [&](const std::string& matrix) {
      ok(query_matrix(matrix + " --c-l 10 --force -o r.json --score " + score));
      const Json report = printed_json("vpr-eval r.json --ground-truth $truth --json");
      return report["best_match"]["rate"].get<double>();
    };
    const double distances = rate("s.npy --distance");
    CHECK(distances > 0.5);
    CHECK(rate("turned.npy --similarity --train-first") == Approx(distances).margin(0.03));
  }
}
