// The filter over places and rates as a user asks for it.
#include <cmath>

#include <catch2/catch.hpp>

#include "base/json.h"
#include "base/npy.h"
#include "support.h"
#include "world.h"

using namespace vpr;
using test::run_program;
using test::world;

namespace {

test::RunOutcome query(std::vector<std::string> words,
                       const std::vector<std::string>& environment = {}) {
  words.insert(words.begin(), {world().database(), "--query"});
  words.insert(words.end(), {"--method", "filter"});
  return run_program("vpr-query", words, environment);
}

}  // namespace

TEST_CASE("a walk is recognised by --method filter alone, at its pace and at twice that") {
  const test::TemporaryFolder folder;
  const std::string back = world().walk("back");
  for (const std::string range : {"", "@::2"}) {
    INFO(range);
    const std::string path = folder / ("r" + std::to_string(range.size()) + ".json");
    const Json json = test::printed_json(query({back + range, "-o", path, "--json"}));
    CHECK(json["settings"]["method"] == "filter");
    CHECK(json["settings"]["c_l"] == 1);
    CHECK(json["settings"]["score"] == "standardized");
    CHECK(json["settings"]["decide"] == "margin");
    CHECK(json["settings"]["margin"] == 3);
    CHECK(json["settings"]["filter"]["sharpness"] == 0.5);
    CHECK(json["totals"]["hits"] > 0);
    CHECK(json["files"]["path"]["rows"] == json["query"]["frames"]);
    CHECK(json["clusters"].size() == 1);  // one track, whatever its rate
    if (!range.empty()) continue;
    const Json report = test::printed_json(
        run_program("vpr-eval", {path, "--ground-truth", world().truth("back"), "--json"}));
    CHECK(report["counts"]["hits"]["correct"] == json["totals"]["hits"]);
    CHECK(report["counts"]["hits"]["incorrect"] == 0);
    CHECK(report["confidence"] == "margin");
    CHECK(report["protocol"]["hits"] ==
          "best matches with a path score better than the best one elsewhere by at least the "
          "margin");
    // The last frame's rate: both walks have one pace.
    const NpyArray rows(folder / "r0.path.npy");
    const auto values = rows.values<double>(2);
    CHECK(values[values.size() - 2] == Approx(1).epsilon(0.3));
    // The result's settings give it again, also on other threads and another SIMD target.
    const auto again = query({back, "--config", path, "--threads", "3", "--json"},
                             {"VPR_SIMD=" + simd_targets().back()});
    CHECK(test::printed_json(again)["clusters"] == json["clusters"]);
  }
}

TEST_CASE("a query of one frame, and one with a gap, are filtered") {
  const std::string back = world().walk("back");
  const Json one = test::printed_json(query({back + "@0:1", "--json"}));
  CHECK(one["totals"]["hits"] == 0);
  CHECK(one["query"]["windows"] == 1);
  const test::TemporaryFolder folder;
  test::write_text(folder / "list.txt", back + "/00000.png\nnowhere.png\n" + back + "/00001.png\n");
  const auto gap = query({folder / "list.txt", "--skip-unreadable", "--json"});
  INFO(gap.err);
  CHECK(gap.exit_code == 0);
}

TEST_CASE("what the filter implies can't be asked for otherwise") {
  const std::string back = world().walk("back");
  for (const auto& [words, named] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--c-l", "5"}, "--c-l"},
           {{"--score", "raw"}, "--score raw"},
           {{"--decide", "threshold"}, "--decide"},
           {{"--margin-width", "4"}, "filter.near_views"},
           {{"--t-r", "-1"}, "t_r"},
           {{"--verify", "3"}, "leave it out with --method filter"}}) {
    std::vector<std::string> all = {back};
    all.insert(all.end(), words.begin(), words.end());
    test::check_failure(query(all), 2, named);
  }
  const test::TemporaryFolder folder;
  test::write_text(folder / "c.json", R"({"filter": {"jump": 2}})");
  test::check_failure(query({back, "--config", folder / "c.json"}), 2, "filter.jump");
}
