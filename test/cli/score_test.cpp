// Z-scores, and decisions by margin, in the programs.
#include <algorithm>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "printed.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

struct Walks {
  TemporaryFolder folder;
  Walks() {
    uint64_t seed = 0;
    for (const char* name : {"one", "two", "query"}) {
      fs::create_directory(folder / name);
      for (int i = 0; i < 20; ++i) write_image(folder / name / fmt::format("{:02}.png", i), ++seed);
    }
    for (int i = 4; i < 14; ++i)  // a revisit of the second sequence
      fs::copy_file(folder / "two" / fmt::format("{:02}.png", i),
                    folder / "query" / fmt::format("{:02}.png", i),
                    fs::copy_options::overwrite_existing);
    run_ok("vpr-train", {"fastable", "--train", folder / "one", "--train", folder / "two", "--c-l",
                         "3", "-o", database()});
    std::string truth = "query,sequence,reference\n";
    for (int i = 4; i < 14; ++i) truth += fmt::format("{0},two,{0}\n", i);
    write_text(folder / "truth.csv", truth);
  }
  std::string database() const { return folder / "db.vprdb"; }
  RunOutcome query(Words words) const {
    return run_program("vpr-query",
                       joined({database(), "--query", folder / "query", "--c-l", "3"}, words));
  }
  std::string refusal(Words words) const {
    const RunOutcome outcome = query(std::move(words));
    CHECK(outcome.exit_code == 2);
    return outcome.err;
  }
};

const Walks& walks() {
  static const Walks kShared;
  return kShared;
}

}  // namespace

TEST_CASE("negative thresholds are accepted as flags, and the result describes the scores") {
  const Json json = printed_json(
      walks().query({"--score", "zscore", "--t-r", "-1.5", "--verify", "50", "--json"}));
  CHECK(json["settings"]["score"] == "zscore");
  CHECK(json["settings"]["t_r"] == -1.5);
  CHECK(json["settings"]["t_r_scale"] == "mean-z");
  CHECK(json["settings"]["zscore"]["forgetting"] == 0.98);
  CHECK(json["statistics"]["neighbor_frames"] == 5);
  CHECK(json["sequences"][1]["limit"] == -3 * 1536);
  CHECK(json["totals"]["recognitions"] > 0);
  CHECK(json["verification"]["differences"] == 0);
  for (const Json& place : json["clusters"]) CHECK(place["best_score"] < -3 * 1536);
  ok(walks().query({"--score", "zscore", "--t-r", "-1.5", "--t-r-scale", "mean-z", "--json"}));
}

TEST_CASE("scales and settings without meaning for a score are usage errors") {
  for (const Words& words :
       {Words{"--score", "zscore", "--t-r", "0.4", "--t-r-scale", "relative"},
        Words{"--score", "zscore", "--t-r", "200", "--t-r-scale", "bits"},
        Words{"--score", "zscore-offline", "--t-r", "200", "--t-r-scale", "bits"},
        Words{"--t-r", "-1", "--t-r-scale", "mean-z"}, Words{"--t-r", "-1"},
        Words{"--score", "zscore", "--method", "openable", "--t-r", "-1"},
        Words{"--score", "zscore", "--method", "lsh", "--t-r", "-1"},
        Words{"--score", "zscore", "--safety-factor", "0.9"}, Words{"--score", "zscore"},
        Words{"--score", "zscore", "--max-memory", "10"}}) {
    const auto outcome = walks().query(joined(words, {"--json"}));
    INFO(fmt::format("{}", outcome.err));
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
  }
}

TEST_CASE("every setting of z-scores can be set in the configuration") {
  write_text(walks().folder / "c.json",
             R"({"score": "zscore", "t_r": -1, "zscore": {"forgetting": 0.9,
                       "start_weight": 3, "deviation_floor": 20, "keyframe_change": 0,
                       "lag_keyframes": 1}})");
  CHECK(printed_json(walks().query({"--config", walks().folder / "c.json", "--verify", "100",
                                    "--json"}))["settings"]["zscore"]["lag_keyframes"] == 1);
  write_text(walks().folder / "t.json",
             R"({"statistics": {"neighbor_frames": 2, "samples": 7, "seed": 3}})");
  run_ok("vpr-train", {"fastable", "--train", walks().folder / "one", "--config",
                       walks().folder / "t.json", "-o", walks().folder / "s.vprdb", "--force"});
  const Json manifest = Json::parse(read_text(walks().folder / "s.vprdb/manifest.json"));
  CHECK(manifest["statistics"]["samples"] == 7);
  CHECK(manifest["statistics"]["seed"] == 3);
}

TEST_CASE("unreadable frames have no score, also in the matrix") {
  const TemporaryFolder folder;
  fs::copy(walks().folder / "query", folder / "query");
  write_text(folder / "query/05.png", "no image");
  run_ok("vpr-query", {walks().database(), "--query", folder / "query", "--c-l", "3", "--score",
                       "zscore", "--t-r", "0", "--skip-unreadable", "--save-matrix",
                       folder / "m.npy", "--verify", "60", "-o", folder / "r.json"});
  const NpyArray best(folder / "r.best.npy");
  const auto rows = best.values<int32_t>(2);
  const auto scores = read_array<double>(folder / "r.best_scores.npy");
  const NpyArray matrix(folder / "m.npy");
  const auto cells = matrix.values<int32_t>(2);
  const size_t cols = matrix.shape()[1];
  for (size_t window = 0; window < best.shape()[0]; ++window) {
    const bool broken = window >= 3 && window <= 5;
    CHECK((rows[3 * window + 1] == -1) == broken);
    for (size_t c = 0; c < cols; ++c)
      CHECK((cells[window * cols + c] == std::numeric_limits<int32_t>::min()) == broken);
    if (!broken)
      CHECK(*std::min_element(cells.begin() + ptrdiff_t(window * cols),
                              cells.begin() + ptrdiff_t((window + 1) * cols)) == scores[window]);
  }
  // The result and its matrix have equal metrics: neither counts windows without scores.
  write_text(folder / "pairs.csv", "query,sequence,reference\n5,two,5\n6,two,6\n9,two,9\n");
  const auto metrics = [&](Words more) {
    Words words =
        joined({folder / "r.json", "--ground-truth", folder / "pairs.csv", "--json"}, more);
    return Json::parse(run_program("vpr-eval", words).out)["metrics"]["single_best"];
  };
  const Json own = metrics({});
  const Json of_matrix = metrics({"--matrix", folder / "m.npy"});
  CHECK(own["positives"] == of_matrix["positives"]);
  CHECK(own["average_precision"] == of_matrix["average_precision"]);
}

TEST_CASE("vpr-tune sweeps thresholds of scores") {
  write_text(walks().folder / "pairs.csv", "query,sequence,reference\n5,two,5\n6,two,6\n");
  const auto sweep = [](const std::string& truth, const std::string& thresholds) {
    return run_program("vpr-tune", {"fastable", walks().database(), "--query",
                                    walks().folder / "query", "--score", "zscore", "--ground-truth",
                                    truth, "--c-l", "2,3", "--t-r", thresholds, "--json"});
  };
  const std::string pairs = walks().folder / "pairs.csv";
  CHECK(sweep("aligned", "-3:-1:1").exit_code == 2);  // aligned needs a single training sequence
  CHECK(sweep(pairs, "-3:-1:1,auto").exit_code == 2);
  const Json cells = printed_json(sweep(pairs, "-3:-1:1"))["cells"];
  REQUIRE(cells.size() == 6);
  for (const Json& cell : cells) CHECK(cell["t_r_scale"] == "mean-z");
}

TEST_CASE("a query by margin recognizes the revisit, and vpr-eval supports either confidence") {
  const fs::path result = walks().folder / "r.json";
  const Json json = printed_json(
      walks().query({"--decide", "margin", "--margin", "400", "-o", result, "--force", "--json"}));
  CHECK(json["settings"]["decide"] == "margin");
  CHECK(json["settings"]["margin"] == 400.0);
  CHECK_FALSE(json["settings"].contains("t_r"));
  CHECK(json["sequences"][1]["margin"] == 400.0);
  CHECK(json["totals"]["recognitions"] == 8);
  CHECK(json["files"].contains("margins"));
  const auto report = [&](Words more) {
    return printed_json(
        "vpr-eval",
        joined({result, "--ground-truth", walks().folder / "truth.csv", "--json"}, more));
  };
  const Json by_score = report({"--confidence", "score"});
  CHECK(by_score["counts"]["pairs"]["correct"] == 8);
  CHECK(by_score["counts"]["pairs"]["incorrect"] == 0);
  CHECK(by_score["metrics"]["by_margin"]["recall_at_100_precision"] >= 0.8);
  CHECK_FALSE(by_score.contains("confidence"));
  const fs::path page = walks().folder / "page.html";
  const Json by_margin = report({"--html", page, "--force"});  // the decision of the result
  CHECK(by_margin["confidence"] == "margin");
  CHECK(by_margin["protocol"]["pairs"] ==
        "best matches with a distance better than the runner-up by at least the margin");
  CHECK(by_margin["metrics"]["single_best"] == by_score["metrics"]["by_margin"]);
  CHECK(by_margin["metrics"]["by_score"]["average_precision"] ==
        by_score["metrics"]["single_best"]["average_precision"]);
  CHECK(by_margin["protocol"]["single_best"].get<std::string>().starts_with("a margin accepts"));
  const std::string html = read_text(page);
  CHECK(has(html, "required margin"));
  CHECK(has(html, "Recognitions by margin"));
  CHECK(has(html, "least margin in "));
  CHECK(has(html, "<label for=\"threshold\">Margin</label>"));
  CHECK(has(html, "\"asked\":400.0"));
  CHECK_FALSE(has(html, "below the threshold"));
  const auto table =
      run_program("vpr-eval", {result, "--ground-truth", walks().folder / "truth.csv", "-v"});
  CHECK(has(table.out, ", by margin\n"));
  CHECK(has(table.out, "best matches, by score"));
}

TEST_CASE("invalid margins and settings without effect are refused with advice") {
  CHECK(has(walks().refusal({"--decide", "margin", "--margin", "-1"}), "from 0 to 65535"));
  CHECK(has(walks().refusal({"--decide", "margin", "--margin", "nan"}), "\"auto\""));
  CHECK(has(walks().refusal({"--decide", "margin", "--margin", "1e9"}), "bits per frame"));
  CHECK(has(walks().refusal({"--decide", "margin", "--margin", "65", "--score", "zscore"}),
            "from 0 to 64 deviations"));
  CHECK(has(walks().refusal({"--margin", "10"}), "--decide margin"));
  CHECK(has(walks().refusal({"--decide", "margin", "--t-r", "0.5"}), "--decide threshold"));
  CHECK(has(walks().refusal({"--decide", "margin", "--method", "lsh"}),
            "--decide margin does not go with --method lsh"));
  CHECK(has(walks().refusal({"--decide", "margin", "--same-place", "one=three"}),
            "the database has one, two"));
  CHECK(has(walks().refusal({"--decide", "maybe"}), "margin"));
}

TEST_CASE("vpr-tune sweeps margins, and its recommendation is a query's settings") {
  const fs::path best = walks().folder / "best.json";
  const Json json =
      printed_json("vpr-tune", {"fastable", walks().database(), "--query", walks().folder / "query",
                                "--ground-truth", walks().folder / "truth.csv", "--c-l", "3",
                                "--decide", "margin", "--margin", "2,400:440:10", "--save-config",
                                best, "--force", "--json"});
  CHECK(json["cells"][0]["margin"] == 2.0);
  CHECK_FALSE(json["cells"][0].contains("t_r"));
  const Json config = Json::parse(read_text(best));
  CHECK(config["decide"] == "margin");
  CHECK(printed_json("vpr-query", {walks().database(), "--query", walks().folder / "query",
                                   "--config", best, "--json"})["totals"]["recognitions"] > 0);
  const auto refused =
      run_program("vpr-tune", {"fastable", walks().database(), "--query", walks().folder / "query",
                               "--ground-truth", walks().folder / "truth.csv", "--margin", "1"});
  CHECK(refused.exit_code == 2);
}
