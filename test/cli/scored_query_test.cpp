// Windows of a matrix that any program computed, as a user asks for them.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "base/npy.h"
#include "support.h"
#include "world.h"

using namespace vpr;
using test::check_failure;
using test::printed_json;
using test::run_program;

namespace {

using Words = std::vector<std::string>;

/// The frame distances of the rendered walks, as a matrix.
struct Matrix {
  test::TemporaryFolder folder;
  size_t queries = 0;
  size_t references = 0;
  std::vector<int32_t> distances;

  Matrix() {
    const Json json = printed_json(run_program(
        "vpr-query", {test::world().database(), "--query", test::world().walk("back"), "--c-l", "1",
                      "--t-r", "0.1", "--save-matrix", path("s.npy"), "--json"}));
    const NpyArray array(path("s.npy"));
    const auto values = array.values<int32_t>(2);
    distances.assign(values.begin(), values.end());
    queries = array.shape()[0];
    references = array.shape()[1];
    for (const Json& target : json["targets"]) frames.push_back(target["frames"]);
    // Similarities with references first: whole steps of 1/1024 below 2.
    std::vector<double> similarities(distances.size());
    for (size_t j = 0; j < queries; ++j)
      for (size_t i = 0; i < references; ++i)
        similarities[i * queries + j] = 2 - distances[j * references + i] / 1024.0;
    test::write_array(path("turned.npy"), similarities, {references, queries});
  }
  std::vector<size_t> frames;  ///< of training sequences
  std::string path(const std::string& name) const { return folder / name; }
  /// As the database has them.
  Words sequences() const {
    return {"--train-sequence", fmt::format("one=0:{}", frames[0]), "--train-sequence",
            fmt::format("two={}:{}", frames[0], frames[0] + frames[1])};
  }
};

const Matrix& matrix() {
  static const Matrix kShared;
  return kShared;
}

test::RunOutcome query_matrix(const std::string& file, const Words& words,
                              const Words& how = {"--distance"}) {
  Words all = {"--scores", matrix().path(file)};
  for (const Words& part : {how, matrix().sequences(), words})
    all.insert(all.end(), part.begin(), part.end());
  return run_program("vpr-query", all);
}

}  // namespace

TEST_CASE("windows of a matrix of frame distances are those of the database") {
  const test::TemporaryFolder out;
  for (const Words& words :
       {Words{"--t-r", "0.65"}, Words{"--t-r", "0.7", "--method", "openable"},
        Words{"--t-r", "150", "--t-r-scale", "bits", "--method", "fastable-online"},
        Words{"--t-r", "0.8"}, Words{"--t-r", "0.65", "--only-sequence", "two"},
        Words{"--t-r", "0.65", "--rates", "1/2,1,2"},
        Words{"--decide", "margin", "--margin", "20", "--margin-width", "4"}}) {
    INFO(fmt::format("{}", fmt::join(words, " ")));
    Words common = words;
    common.insert(common.end(), {"--c-l", "10", "--margin-width", "4", "--same-place", "none"});
    if (words.front() == "--decide") common.resize(common.size() - 4);
    if (words.front() == "--decide") common.insert(common.end(), {"--same-place", "none"});
    Words coded = {test::world().database(), "--query", test::world().walk("back"), "-o",
                   out / "coded.json",       "--force"};
    coded.insert(coded.end(), common.begin(), common.end());
    REQUIRE(run_program("vpr-query", coded).exit_code == 0);
    Words read = common;
    read.insert(read.end(), {"-o", out / "read.json", "--force"});
    const auto outcome = query_matrix("s.npy", read);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    for (const char* kind : {"hits", "hit_scores", "best", "best_scores", "margins"})
      CHECK(test::read_text(out / fmt::format("coded.{}.npy", kind)) ==
            test::read_text(out / fmt::format("read.{}.npy", kind)));
    const Json json = Json::parse(test::read_text(out / "read.json"));
    CHECK(json["scores"] ==
          Json{{"kind", "distance"}, {"best", 0.0}, {"unit", 1.0}, {"is_exact", true}});
    CHECK(json["clusters"] == Json::parse(test::read_text(out / "coded.json"))["clusters"]);
  }
}

TEST_CASE("a result says what the scores of its matrix are, and whether they were rounded") {
  const Json exact = printed_json(query_matrix("s.npy", {"--c-l", "7", "--t-r", "0.6", "--json"}));
  CHECK(exact["scores"]["is_exact"].get<bool>());
  const Json rounded =
      printed_json(query_matrix("turned.npy", {"--c-l", "7", "--t-r", "0.6", "--json"},
                                {"--similarity", "--references-first"}));
  CHECK(rounded["scores"]["kind"] == "similarity");
  CHECK_FALSE(rounded["scores"]["is_exact"].get<bool>());
}

TEST_CASE("similarities have the best matches of distances, and are evaluated like any result") {
  const test::TemporaryFolder out;
  for (const char* score : {"raw", "standardized", "standardized-offline"}) {
    INFO(score);
    for (const auto& [file, how] :
         {std::pair("s.npy", Words{"--distance"}),
          std::pair("turned.npy", Words{"--similarity", "--references-first"})}) {
      const auto outcome = query_matrix(
          file,
          {"--c-l", "10", "--score", score, "--force", "-o", out / fmt::format("{}.json", file)},
          how);
      INFO(outcome.err);
      REQUIRE(outcome.exit_code == 0);
    }
    const Json report = printed_json(run_program(
        "vpr-eval", {out / "s.npy.json", "--ground-truth", test::world().truth("back"), "--json"}));
    const Json turned =
        printed_json(run_program("vpr-eval", {out / "turned.npy.json", "--ground-truth",
                                              test::world().truth("back"), "--json"}));
    CHECK(report["best_match"]["rate"].get<double>() > 0.5);
    CHECK(std::abs(report["best_match"]["rate"].get<double>() -
                   turned["best_match"]["rate"].get<double>()) < 0.03);
  }
}

TEST_CASE("a matrix alone says what is missing") {
  const auto check = [](const Words& words, int code, const std::string& word) {
    Words all = {"--scores", matrix().path("s.npy")};
    all.insert(all.end(), words.begin(), words.end());
    check_failure(run_program("vpr-query", all), code, word);
  };
  check({}, 2, "say what the scores are");
  check({"--distance", "--decide", "margin"}, 2, "--margin-width");
  check({"--distance", "--method", "filter"}, 2, "needs descriptors");
  check({"--distance", "--method", "lsh"}, 2, "needs descriptors");
  check({"--distance", "--follow"}, 2, "--follow");
  check({"--distance", "--query-npy", "x.npy"}, 2, "--query-npy");
  check({"--distance", "--score", "standardized", "--verify", "5"}, 2, "--verify");
  check({"--distance", "--train-sequence", "a=0:100000"}, 2, "the matrix has");
  check({"--distance", "--train-sequence", "0:5"}, 2, "NAME=FIRST:LAST");
  check({"--distance", "--train-sequence", "a=0:5", "--train-sequence", "a=5:9"}, 2, "called a");
  check({"--distance", "--c-l", "100000"}, 2, "c_l");
  check_failure(run_program("vpr-query", {test::world().database(), "--scores",
                                          matrix().path("s.npy"), "--distance"}),
                2, "give one of them");
  check_failure(run_program("vpr-query", {"--query", test::world().walk("back")}), 2,
                "give the database");
  check_failure(run_program("vpr-query", {test::world().database(), "--query",
                                          test::world().walk("back"), "--similarity"}),
                2, "give it with --scores");
}
