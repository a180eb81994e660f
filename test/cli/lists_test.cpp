// Lists of pairs and predictions, as a user brings and takes them.
#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/npy.h"
#include "base/random.h"
#include "support.h"
#include "world.h"

using namespace vpr;
using test::check_failure;
using test::printed_json;
using test::run_program;

namespace {

using Words = std::vector<std::string>;

constexpr size_t kFrames = 20;

/// Similarities of 20 queries to 20 references: the right one is often among the best.
struct Scored {
  test::TemporaryFolder folder;
  Scored() {
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
    test::write_array(folder / "s.npy", scores, {kFrames, kFrames});
    test::write_text(folder / "q.txt", queries);
    test::write_text(folder / "db.txt", references);
  }
  std::string path(const std::string& name) const { return folder / name; }
  Words named() const { return {"--query", path("q.txt"), "--train", path("db.txt")}; }
};

test::RunOutcome evaluate(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return run_program("vpr-eval", words);
}

const Words kTruth = {"--ground-truth", "aligned", "--tolerance", "0", "--json"};

}  // namespace

TEST_CASE("pairs that are written are read again, with the recall of the scores") {
  const Scored scored;
  const Words source = {"--scores", scored.path("s.npy"), "--similarity"};
  const Json scores = printed_json(evaluate(source, kTruth));
  Words write = {"--top-k", "10", "--pairs", scored.path("pairs.txt")};
  for (const std::string& word : scored.named()) write.push_back(word);
  const auto written = evaluate(source, write);
  CHECK(written.exit_code == 0);
  CHECK(written.out.find("200 pairs") != std::string::npos);
  CHECK(test::read_text(scored.path("pairs.txt")).starts_with("query/00.jpg db/"));
  Words read = {"--predictions", scored.path("pairs.txt")};
  for (const std::string& word : scored.named()) read.push_back(word);
  const Json pairs = printed_json(evaluate(read, kTruth));
  for (const char* k : {"1", "5", "10"})
    CHECK(pairs["metrics"]["recall_at"][k] == scores["metrics"]["recall_at"][k]);
  CHECK(scores["metrics"]["recall_at"]["1"].get<double>() > 0.3);
  CHECK(scores["metrics"]["recall_at"]["1"].get<double>() < 1);
  // Beside a report, and with numbers as names.
  const auto numbered = evaluate(
      source, {"--ground-truth", "aligned", "--pairs", scored.path("numbers.txt"), "--top-k", "1"});
  CHECK(numbered.exit_code == 0);
  CHECK(printed_json(evaluate({"--predictions", scored.path("numbers.txt")},
                              kTruth))["metrics"]["recall_at"]["1"] ==
        scores["metrics"]["recall_at"]["1"]);
}

TEST_CASE("predictions of VPR-methods-evaluation are judged") {
  const Scored scored;
  std::filesystem::create_directory(scored.folder / "preds");
  for (size_t j = 0; j < kFrames; ++j)
    test::write_text(scored.folder / fmt::format("preds/{:03}.txt", j),
                     fmt::format("Query path:\n/x/query/{:02}.jpg\n\nPredictions paths:\n"
                                 "/x/db/{:02}.jpg\n/x/db/{:02}.jpg\n\nPositives paths:\n\n",
                                 j, (j + j % 2) % kFrames, (j + 1) % kFrames));
  Words words = {"--predictions", scored.path("preds")};
  for (const std::string& word : scored.named()) words.push_back(word);
  const Json report = printed_json(evaluate(words, kTruth));
  CHECK(report["metrics"]["recall_at"]["1"] == 0.5);
  CHECK(report["machine"]["paths"]["predictions"] == scored.path("preds"));
}

TEST_CASE("pairs of a result are its best matches, or those of its matrix") {
  const test::TemporaryFolder out;
  REQUIRE(run_program("vpr-query",
                      {test::world().database(), "--query", test::world().walk("back"), "--c-l",
                       "5", "--t-r", "0.5", "-o", out / "r.json", "--save-matrix", out / "m.npy"})
              .exit_code == 0);
  const Words names = {"--query", test::world().walk("back"), "--train", test::world().walk("one"),
                       "--train", test::world().walk("two")};
  Words best = {out / "r.json", "--pairs", out / "best.txt"};
  best.insert(best.end(), names.begin(), names.end());
  REQUIRE(run_program("vpr-eval", best).exit_code == 0);
  Words three = {out / "r.json", "--scores",       out / "m.npy", "--top-k", "3",
                 "--pairs",      out / "three.txt"};
  three.insert(three.end(), names.begin(), names.end());
  REQUIRE(run_program("vpr-eval", three).exit_code == 0);
  const std::string one = test::read_text(out / "best.txt");
  const std::string all = test::read_text(out / "three.txt");
  CHECK(3 * std::count(one.begin(), one.end(), '\n') == std::count(all.begin(), all.end(), '\n'));
  CHECK(all.starts_with(one.substr(0, one.find('\n'))));
  CHECK(one.starts_with(test::world().walk("back")));
  check_failure(run_program("vpr-eval", {out / "r.json", "--pairs", out / "x.txt"}), 2,
                "name the frames of all 2 training sequences");
  check_failure(run_program("vpr-eval", {out / "r.json", "--pairs", out / "x.txt", "--top-k", "2"}),
                2, "the matrix");
}

TEST_CASE("flags of lists that do not go together") {
  const Scored scored;
  test::write_text(scored.folder / "p.txt", "0 1 0.5\n");
  const auto check = [&](const Words& words, const std::string& word) {
    check_failure(evaluate({"--predictions", scored.path("p.txt")}, words), 2, word);
  };
  check(kTruth, "has scores");
  check({"--scores", scored.path("s.npy"), "--distance"}, "by themselves");
  check({"--missing", "3", "--distance"}, "--missing");
  check({"--top-k", "3"}, "--top-k");
  check({"--top-k", "0", "--pairs", scored.path("x.txt")}, "--top-k must be");
  check_failure(evaluate({"--predictions", scored.path("nowhere.txt")}, kTruth), 3, "nowhere.txt");
  check({"--similarity", "--pairs", scored.path("x.txt"), "-o", scored.path("x.json")},
        "there is no report to write");
  for (const Words& words : {Words{"--pairs", "x"}, Words{"--junit", "x"}, Words{"--update"}}) {
    Words several = {"r.json", "s.json", "--ground-truth", "aligned"};
    several.insert(several.end(), words.begin(), words.end());
    check_failure(run_program("vpr-eval", several), 2, "take one result");
    Words protocol = {"r.json", "--protocol", "nordland-exact"};
    protocol.insert(protocol.end(), words.begin(), words.end());
    check_failure(run_program("vpr-eval", protocol), 2, "protocol");
  }
}
