// --warp as a user gives it: replays of a query, and what is judged of them.
#include <algorithm>

#include <catch2/catch.hpp>

#include "base/json.h"
#include "base/npy.h"
#include "cli/world.h"
#include "images/selection.h"
#include "support.h"

using namespace vpr;
using test::run_program;
using test::world;

namespace {

std::vector<std::string> joined(std::vector<std::string> words, std::vector<std::string> more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// Single frames, so that what is right does not depend on the frames beside them.
test::RunOutcome query(const std::string& output, const std::vector<std::string>& more) {
  return run_program("vpr-query", joined({world().database(), "--dataset", world().dataset(),
                                          "--c-l", "1", "--t-r", "0.3", "-o", output},
                                         more));
}

Json evaluate(const std::string& result, const std::vector<std::string>& more = {}) {
  return test::printed_json(
      run_program("vpr-eval", joined({result, "--dataset", world().dataset(), "--json"}, more)));
}

// One letter a frame.
std::string outcomes(const Json& report) { return report["outcomes"]["best"].get<std::string>(); }

}  // namespace

TEST_CASE("A replayed query is judged frame by frame as the query is") {
  const test::TemporaryFolder out;
  REQUIRE(query(out / "plain.json", {}).exit_code == 0);
  const Json plain = evaluate(out / "plain.json");
  CHECK_FALSE(plain.contains("warp"));
  const std::string expected = outcomes(plain);
  for (const char* warp : {"0.5", "0.67", "1.5", "2", "0.9", "varying", "stops", "reversed"}) {
    INFO(warp);
    const std::string result = out / (std::string(warp) + ".json");
    REQUIRE(query(result, {"--warp", warp, "--seed", "3"}).exit_code == 0);
    const Json report = evaluate(result);
    const Replay shown = replay(warp, expected.size(), 3);
    CHECK(report["warp"] == Json{{"name", warp}, {"seed", 3}, {"frames", expected.size()}});
    CHECK(report["protocol"]["ground_truth"].get<std::string>().find("query replayed ") !=
          std::string::npos);
    std::string replayed;
    for (const uint32_t source : shown.sources) replayed += expected[source];
    CHECK(outcomes(report) == replayed);
  }
  const Json kept = Json::parse(test::read_text(out / "varying.json"));
  CHECK(kept["query"]["warp"]["name"] == "varying");
  const NpyArray sources(out / "varying.source_frames.npy");
  CHECK(sources.values<int32_t>(1).size() == kept["query"]["frames"].get<size_t>());
}

TEST_CASE("A warp gives the same bytes on any number of threads, and others for another seed") {
  const test::TemporaryFolder out;
  const auto bytes = [&](const std::string& name, const std::vector<std::string>& more) {
    REQUIRE(query(out / (name + ".json"), joined({"--warp", "varying"}, more)).exit_code == 0);
    return test::read_text(out / (name + ".source_frames.npy")) +
           test::read_text(out / (name + ".best.npy"));
  };
  const std::string one = bytes("a", {"--threads", "1"});
  CHECK(bytes("b", {"--threads", "3"}) == one);
  CHECK(bytes("c", {"--seed", "2"}) != one);
}

TEST_CASE("What is printed names the warp") {
  const test::TemporaryFolder out;
  CHECK(query(out / "a.json", {}).out.find("replayed") == std::string::npos);
  const auto warped = query(out / "b.json", {"--warp", "varying", "--seed", "7"});
  CHECK(warped.out.find("back, replayed by varying, seed 7: ") != std::string::npos);
}

TEST_CASE("FAB-MAP replays a query, too") {
  const test::TemporaryFolder out;
  const auto run = [&](const std::string& name, const std::vector<std::string>& more) {
    return run_program("vpr-query", joined({world().fabmap(), "--query", world().walk("back"),
                                            "--t-p", "0.5", "-o", out / name},
                                           more));
  };
  REQUIRE(run("plain.json", {}).exit_code == 0);
  const auto slowed = run("slow.json", {"--warp", "0.5", "--explain", "5"});
  REQUIRE(slowed.exit_code == 0);
  CHECK(slowed.out.find("back, replayed at pace 0.5: ") != std::string::npos);
  const auto best_of = [&](const char* name) {
    const NpyArray array(out / name);
    const auto values = array.values<int32_t>(2);
    std::vector<int32_t> places;
    for (size_t row = 0; row < values.size() / 4; ++row) places.push_back(values[4 * row + 2]);
    return places;
  };
  const std::vector<int32_t> plain = best_of("plain.best.npy");
  const std::vector<int32_t> slow = best_of("slow.best.npy");
  REQUIRE(slow.size() == 2 * plain.size());
  for (size_t k = 0; k < slow.size(); ++k) CHECK(slow[k] == plain[k / 2]);
  test::check_failure(run("loop.json", {"--warp", "2", "--loop"}), 2, "--loop");
}

TEST_CASE("Scores of a replay are judged as the result is, and a sweep counts as both do") {
  const test::TemporaryFolder out;
  REQUIRE(query(out / "r.json", {"--warp", "stops", "--seed", "5", "--only-sequence", "one",
                                 "--save-matrix", out / "d.npy"})
              .exit_code == 0);
  const Json report = test::printed_json(run_program(
      "vpr-eval", {out / "r.json", "--ground-truth", "aligned", "--tolerance", "9", "--json"}));
  const std::string frames = report["warp"]["frames"].dump();
  const auto judge = [&](const std::vector<std::string>& more) {
    return run_program("vpr-eval", joined({"--scores", out / "d.npy", "--distance", "--json",
                                           "--ground-truth", "aligned", "--tolerance", "9"},
                                          more));
  };
  const Json scores =
      test::printed_json(judge({"--warp", "stops", "--seed", "5", "--query-frames", frames}));
  CHECK(outcomes(scores) == outcomes(report));
  CHECK(scores["warp"] == report["warp"]);
  test::check_failure(judge({"--warp", "stops", "--seed", "6", "--query-frames", frames}), 4,
                      "give the warp");
  test::check_failure(judge({"--warp", "stops"}), 2, "--query-frames");
  test::check_failure(judge({"--query-frames", frames}), 4, "need a query of 64 frames");
  test::check_failure(run_program("vpr-eval", {out / "r.json", "--dataset", world().dataset(),
                                               "--warp", "2", "--query-frames", frames}),
                      2, "does not go with a result");

  const Json sweep = test::printed_json(
      run_program("vpr-tune", {"fastable", world().database(), "--dataset", world().dataset(),
                               "--c-l", "1,4", "--t-r", "0.2,0.3", "--warp", "varying", "--json"}));
  CHECK(sweep["queries"][0]["warp"]["name"] == "varying");
  REQUIRE(query(out / "v.json", {"--warp", "varying"}).exit_code == 0);
  const Json counts = evaluate(out / "v.json");
  CHECK(sweep["cells"][1]["counts"] == counts["counts"]);
  CHECK(sweep["cells"][1]["best_match"]["correct"] == counts["best_match"]["correct"]);
}

TEST_CASE("Pictures and maps of a replay show the frames of the query") {
  const test::TemporaryFolder out;
  REQUIRE(query(out / "r.json", {"--warp", "reversed"}).exit_code == 0);
  REQUIRE(run_program("vpr-eval", {out / "r.json", "--dataset", world().dataset(), "--html",
                                   out / "r.html", "--map", out / "map"})
              .exit_code == 0);
  const std::string page = test::read_text(out / "r.html");
  const size_t frames =
      Json::parse(test::read_text(out / "r.json"))["query"]["frames"].get<size_t>();
  // A card's caption names the frame of the replay, and the file that it shows.
  size_t captions = 0;
  for (size_t at = page.find("<figcaption>query "); at != std::string::npos;
       at = page.find("<figcaption>query ", at + 1)) {
    const size_t frame = std::stoul(page.substr(at + 18));
    const size_t name = page.find(": ", at) + 2;
    CHECK(std::stoul(page.substr(name)) == frames - 1 - frame);
    ++captions;
  }
  CHECK(captions > 0);
  CHECK(test::list_folder(out / "map").size() > 1);
}

TEST_CASE("What is no warp, or does not fit the query, is a usage error") {
  const test::TemporaryFolder out;
  test::check_failure(query(out / "r.json", {"--warp", "stop"}), 2, "stops");
  for (const char* pace : {"0", "nan", "1e9", "-1"})
    test::check_failure(query(out / "r.json", {std::string("--warp=") + pace}), 2,
                        "from 0.1 to 10");
  const auto of_frames = [&](const std::string& frames, const std::string& warp) {
    return run_program(
        "vpr-query", {world().database(), "--query", world().walk("back") + "@0:" + frames, "--c-l",
                      "1", "--t-r", "0.3", "--warp", warp, "-o", out / "r.json"});
  };
  test::check_failure(of_frames("3", "kidnap"), 2, "41 frames or more, found 3");
  CHECK(of_frames("1", "stops").exit_code == 0);
  CHECK(Json::parse(test::read_text(out / "r.json"))["query"]["frames"] == 1);
}

TEST_CASE(
    "Windows of several rates are verified by definition, and keep the rate of best matches") {
  const test::TemporaryFolder out;
  const auto run = [&](const std::string& name, const std::vector<std::string>& more) {
    return run_program("vpr-query", joined({world().database(), "--dataset", world().dataset(),
                                            "--c-l", "8", "--t-r", "0", "-o", out / name},
                                           more));
  };
  const std::vector<std::string> rates = {"--rates", "1/2,2/3,1,3/2,2"};
  for (const char* score : {"raw", "standardized"}) {
    INFO(score);
    const auto outcome = run("r.json", joined(rates, {"--score", score, "--warp", "2", "--force"}));
    REQUIRE(outcome.exit_code == 0);
  }
  const NpyArray array(out / "r.best_rates.npy");
  const auto found = array.values<double>(1);
  const Json result = Json::parse(test::read_text(out / "r.json"));
  CHECK(result["settings"]["rates"] == Json{"1/2", "2/3", "1", "3/2", "2"});
  REQUIRE(found.size() == result["query"]["windows"].get<size_t>());
  CHECK(std::count(found.begin(), found.end(), 2.0) > static_cast<long>(found.size() / 2));
  CHECK(evaluate(out / "r.json")["best_match"]["correct"].get<int>() > 0);

  REQUIRE(run("one.json", {"--rates", "1"}).exit_code == 0);
  REQUIRE(run("plain.json", {}).exit_code == 0);
  CHECK(test::read_text(out / "one.best.npy") == test::read_text(out / "plain.best.npy"));
  CHECK(test::read_text(out / "plain.json").find("rates") == std::string::npos);
  test::check_failure(run("x.json", joined(rates, {"--method", "openable"})), 2, "--rates");
  test::check_failure(run("x.json", {"--rates", "0/1"}), 2, "3/2");
  test::check_failure(run("x.json", {"--rates", "1,2/2"}), 2, "twice");
}
