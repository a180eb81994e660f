// Decisions by margin as a user asks for them.
#include <filesystem>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "support.h"

using namespace vpr;
using test::run_program;
namespace fs = std::filesystem;

namespace {

struct Walks {
  test::TemporaryFolder folder;
  Walks() {
    uint64_t seed = 0;
    for (const char* name : {"one", "two", "query"}) {
      fs::create_directory(folder / name);
      for (int i = 0; i < 20; ++i)
        test::write_image(folder / name / fmt::format("{:02}.png", i), ++seed);
    }
    for (int i = 4; i < 14; ++i)  // a revisit of the second walk
      fs::copy_file(folder / "two" / fmt::format("{:02}.png", i),
                    folder / "query" / fmt::format("{:02}.png", i),
                    fs::copy_options::overwrite_existing);
    REQUIRE(run_program("vpr-train", {"fastable", "--train", folder / "one", "--train",
                                      folder / "two", "--c-l", "3", "-o", database()})
                .exit_code == 0);
    test::write_text(folder / "truth.csv", truth());
  }
  std::string database() const { return folder / "db.vprdb"; }
  static std::string truth() {
    std::string text = "query,sequence,reference\n";
    for (int i = 4; i < 14; ++i) text += fmt::format("{0},two,{0}\n", i);
    return text;
  }
  test::RunOutcome query(std::vector<std::string> words) const {
    words.insert(words.begin(), {database(), "--query", folder / "query", "--c-l", "3"});
    return run_program("vpr-query", words);
  }
  std::string refusal(std::vector<std::string> words) const {
    const test::RunOutcome outcome = query(std::move(words));
    CHECK(outcome.exit_code == 2);
    return outcome.err;
  }
};

const Walks& walks() {
  static const Walks kShared;
  return kShared;
}

bool has(const std::string& text, const std::string& words) {
  INFO(text);
  return text.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("a query by margin recognises the revisit, and vpr-eval judges by either confidence") {
  const fs::path result = walks().folder / "r.json";
  const auto outcome =
      walks().query({"--decide", "margin", "--margin", "400", "-o", result, "--force", "--json"});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const Json json = Json::parse(outcome.out);
  CHECK(json["settings"]["decide"] == "margin");
  CHECK(json["settings"]["margin"] == 400.0);
  CHECK_FALSE(json["settings"].contains("t_r"));
  CHECK(json["targets"][1]["margin"] == 400.0);
  CHECK(json["totals"]["hits"] == 8);
  CHECK(json["files"].contains("margins"));
  const auto report = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {result, "--ground-truth", walks().folder / "truth.csv",
                                      "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const auto evaluated = run_program("vpr-eval", words);
    INFO(evaluated.err);
    REQUIRE(evaluated.exit_code == 0);
    return Json::parse(evaluated.out);
  };
  const Json by_score = report({"--confidence", "score"});
  CHECK(by_score["counts"]["hits"]["correct"] == 8);
  CHECK(by_score["counts"]["hits"]["incorrect"] == 0);
  CHECK(by_score["metrics"]["by_margin"]["recall_at_100_precision"] >= 0.8);
  CHECK_FALSE(by_score.contains("confidence"));
  const fs::path page = walks().folder / "page.html";
  const Json by_margin = report({"--html", page, "--force"});  // as the result was decided
  CHECK(by_margin["confidence"] == "margin");
  CHECK(by_margin["protocol"]["hits"] ==
        "best matches with a distance better than the best one elsewhere by at least the margin");
  CHECK(by_margin["metrics"]["single_best"] == by_score["metrics"]["by_margin"]);
  CHECK(by_margin["metrics"]["by_score"]["average_precision"] ==
        by_score["metrics"]["single_best"]["average_precision"]);
  CHECK(by_margin["protocol"]["single_best"].get<std::string>().rfind("a margin accepts", 0) == 0);
  const std::string html = test::read_text(page);
  CHECK(has(html, "margin asked for"));
  CHECK(has(html, "What a margin recognizes"));
  CHECK(has(html, "the margin per frame, or more"));
  CHECK(has(html, "<label for=\"threshold\">Margin</label>"));
  CHECK(has(html, "\"asked\":400.0"));
  CHECK_FALSE(has(html, "below the threshold"));
  const auto table =
      run_program("vpr-eval", {result, "--ground-truth", walks().folder / "truth.csv"});
  CHECK(has(table.out, "the same by score"));
}

TEST_CASE("margins that can't be, and settings that decide nothing, are refused with what to do") {
  CHECK(has(walks().refusal({"--decide", "margin", "--margin", "-1"}), "from 0 to 65535"));
  CHECK(has(walks().refusal({"--decide", "margin", "--margin", "nan"}), "\"auto\""));
  CHECK(has(walks().refusal({"--decide", "margin", "--margin", "1e9"}), "bits a frame"));
  CHECK(has(walks().refusal({"--decide", "margin", "--margin", "65", "--score", "standardized"}),
            "from 0 to 64 deviations"));
  CHECK(has(walks().refusal({"--margin", "10"}), "--decide margin"));
  CHECK(has(walks().refusal({"--decide", "margin", "--t-r", "0.5"}), "--decide threshold"));
  CHECK(has(walks().refusal({"--decide", "margin", "--method", "lsh"}), "lsh finds some"));
  CHECK(has(walks().refusal({"--decide", "margin", "--same-place", "one=three"}),
            "the database has one, two"));
  CHECK(has(walks().refusal({"--decide", "maybe"}), "margin"));
}

TEST_CASE("a query by margin that recognizes nothing suggests no smaller one") {
  const auto few = walks().query({"--decide", "margin", "--margin", "1000"});
  CHECK(few.exit_code == 0);
  INFO(few.out);
  CHECK(has(few.out, " frames are recognized"));
  CHECK_FALSE(has(few.out, "--margin"));
}

TEST_CASE("vpr-tune sweeps margins, and its recommendation is a query's settings") {
  const fs::path best = walks().folder / "best.json";
  const auto tuned =
      run_program("vpr-tune", {"fastable", walks().database(), "--query", walks().folder / "query",
                               "--ground-truth", walks().folder / "truth.csv", "--c-l", "3",
                               "--decide", "margin", "--margin", "2,400:440:10", "--save-config",
                               best, "--force", "--json"});
  INFO(tuned.err);
  REQUIRE(tuned.exit_code == 0);
  const Json json = Json::parse(tuned.out);
  CHECK(json["cells"][0]["margin"] == 2.0);
  CHECK_FALSE(json["cells"][0].contains("t_r"));
  const Json config = Json::parse(test::read_text(best));
  CHECK(config["decide"] == "margin");
  const auto outcome = run_program(
      "vpr-query",
      {walks().database(), "--query", walks().folder / "query", "--config", best, "--json"});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(Json::parse(outcome.out)["totals"]["hits"] > 0);
  const auto refused =
      run_program("vpr-tune", {"fastable", walks().database(), "--query", walks().folder / "query",
                               "--ground-truth", walks().folder / "truth.csv", "--margin", "1"});
  CHECK(refused.exit_code == 2);
}
