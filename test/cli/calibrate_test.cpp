// vpr-tune calibrate as a user runs it.
#include <catch2/catch.hpp>

#include "base/json.h"
#include "cli/world.h"
#include "support.h"

using namespace vpr;
using test::check_failure;
using test::run_program;
using test::world;

namespace {

std::vector<std::string> calibrate(std::vector<std::string> more, std::string truth = "") {
  if (truth.empty()) truth = world().truth("back");
  std::vector<std::string> words = {"calibrate",      world().database(),
                                    "--query",        world().walk("back"),
                                    "--ground-truth", truth,
                                    "--c-l",          "5,10"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Json query_with(const std::string& config, const test::TemporaryFolder& out) {
  REQUIRE(run_program("vpr-query", {world().database(), "--query", world().walk("back"), "--config",
                                    config, "--force", "-o", out / "r.json"})
              .exit_code == 0);
  return test::printed_json(
      run_program("vpr-eval", {out / "r.json", "--ground-truth", world().truth("back"), "--json"}));
}

}  // namespace

TEST_CASE("vpr-query takes a calibration as its configuration, and has its recognitions") {
  const test::TemporaryFolder out;
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--score", "raw"}, {"--method", "filter"}}) {
    std::vector<std::string> words = calibrate({"-o", out / "c.json", "--force", "--fps", "4"});
    words.insert(words.end(), more.begin(), more.end());
    const Json calibration = [&] {
      words.emplace_back("--json");
      return test::printed_json(run_program("vpr-tune", words));
    }();
    CHECK(Json::parse(test::read_text(out / "c.json")) == calibration);
    const size_t chosen = calibration["chosen"];
    const Json& recognised = calibration["lengths"][chosen]["recognised"];
    CHECK(recognised["wrong"] == 0);
    const Json hits = query_with(out / "c.json", out)["counts"]["hits"];
    CHECK(hits["incorrect"] == 0);
    CHECK(hits["correct"] == recognised["right"]);
    const double windows = calibration["lengths"][chosen]["windows"];
    const Json& interval = calibration["lengths"][chosen]["false_recognitions"]["interval"];
    CHECK(calibration["in_an_hour"]["interval"][1].get<double>() ==
          Approx(interval[1].get<double>() * 4 * 3600 / windows));
  }
}

TEST_CASE("a calibration is the same for any number of threads, but for machine and timing") {
  std::vector<Json> found;
  for (const char* threads : {"1", "3"}) {
    found.push_back(
        test::printed_json(run_program("vpr-tune", calibrate({"--threads", threads, "--json"}))));
    found.back().erase("machine");
    found.back().erase("timing");
  }
  CHECK(found[0] == found[1]);
}

TEST_CASE("what can't be calibrated is said in a sentence") {
  const test::TemporaryFolder out;
  const auto fails = [&](std::vector<std::string> more, int exit_code, const std::string& words) {
    check_failure(run_program("vpr-tune", calibrate(std::move(more))), exit_code, words);
  };
  fails({"--precision", "0"}, 2, "precision must be above 0 and at most 1, found 0");
  fails({"--fps", "0"}, 2, "--fps must be above 0");
  fails({"--method", "lsh", "--score", "raw"}, 2, "unknown method \"lsh\"");
  test::write_text(out / "raw.json", R"({"c_l": 5, "t_r": -1.5})");
  fails({"--config", out / "raw.json"}, 2, "decide nothing with --decide margin");
  test::write_text(out / "fused.json", R"({"score": "standardized", "fuse_beta": 0.2})");
  fails({"--config", out / "fused.json"}, 2, "vpr-tune calibrate has no --fuse");
  test::write_text(out / "none.csv", "query,sequence,reference,label\n0,one,0,ignore\n");
  check_failure(run_program("vpr-tune", calibrate({}, out / "none.csv")), 2,
                "shows no trained place by the ground truth");
  check_failure(
      run_program("vpr-tune", {"calibrate", world().database(), "--query", world().walk("back")}),
      2, "give --query and --ground-truth");
  check_failure(
      run_program("vpr-tune", {"calibrate", world().database(), "--query",
                               world().walk("back") + "@0:1", "--ground-truth", "aligned"}),
      2, "no 10 readable ones in a row");
  test::write_text(out / "wrong.csv", "query,sequence,reference\n20,one,0\n21,one,0\n22,two,0\n");
  const test::RunOutcome wrong =  // there is a warning, too, that few frames are labelled
      run_program("vpr-tune", calibrate({"-o", out / "c.json"}, out / "wrong.csv"));
  CHECK(wrong.exit_code == 5);
  CHECK(wrong.err.find("no margin") != std::string::npos);
  CHECK(!std::filesystem::exists(out / "c.json"));
}
