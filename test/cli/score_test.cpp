// Z-scores and decisions by margin, in the programs.
#include <algorithm>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "npz.h"
#include "world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

// Two training sequences; the query revisits the second one.
void make_walks() {
  write_walk("one", 20, 1);
  write_walk("two", 20, 21);
  write_walk("query", 20, 41);
  std::string truth = "query,sequence,reference\n";
  for (int i = 4; i < 14; ++i) {
    const std::string name = fmt::format("/{:02}.png", i);
    fs::copy_file("two" + name, "query" + name, fs::copy_options::overwrite_existing);
    truth += fmt::format("{0},two,{0}\n", i);
  }
  write_text("truth.csv", truth);
  run_ok("vpr-train fastable --train one --train two --c-l 3 -o db.vprdb");
}

const std::string kQuery = "vpr-query db.vprdb --query query --c-l 3";

RunOutcome query(const std::string& words) { return run(kQuery + " " + words); }

}  // namespace

TEST_CASE("negative thresholds are accepted as flags, and the result describes the scores") {
  start_with(make_walks);
  const Json json = printed_json(query("--score zscore --t-r -1.5 --json"));
  CHECK(json["settings"]["score"] == "zscore");
  CHECK(json["settings"]["t_r"] == -1.5);
  CHECK(json["settings"]["t_r_scale"] == "mean-z");
  CHECK(json["statistics"]["neighbor_frames"] == 5);
  CHECK(json["sequences"][1]["limit"] == -3 * 1536);
  CHECK(json["totals"]["recognitions"] > 0);
  for (const Json& place : json["clusters"]) CHECK(place["best_score"] < -3 * 1536);
  ok(query("--score zscore --t-r -1.5 --t-r-scale mean-z --json"));
}

TEST_CASE("settings of training statistics can be set in the configuration") {
  start_with(make_walks);
  write_text("t.json", R"({"statistics": {"neighbor_frames": 2, "samples": 7, "seed": 3}})");
  run_ok("vpr-train fastable --train one --config t.json -o s.vprdb --force");
  const Json manifest = Json::parse(read_text("s.vprdb/manifest.json"));
  CHECK(manifest["statistics"]["samples"] == 7);
  CHECK(manifest["statistics"]["seed"] == 3);
}

TEST_CASE("unreadable frames have no score, also in the matrix, and no metric counts them") {
  start_with(make_walks);
  write_text("query/05.png", "no image");
  check_failure(query("-o r.json"), 3, "05.png");
  for (const auto& [score, missing] : std::vector<std::pair<std::string, int32_t>>{
           {"raw", -1}, {"zscore --t-r 0", std::numeric_limits<int32_t>::min()}}) {
    INFO(score);
    ok(query("--skip-unreadable --save-matrix m.npy --force -o r.json --score " + score));
    const auto rows = npz_array<int32_t>("r.npz", "best");
    const auto scores = npz_array<double>("r.npz", "best_scores");
    const NpyArray matrix("m.npy");
    const auto cells = matrix.values<int32_t>(2);
    const size_t cols = matrix.shape()[1];
    for (size_t window = 0; window < scores.size(); ++window) {
      const bool broken = window >= 3 && window <= 5;
      const auto row = cells.subspan(window * cols, cols);
      CHECK((rows[3 * window + 1] == -1) == broken);
      CHECK(size_t(std::ranges::count(row, missing)) == (broken ? cols : 0));
      if (!broken) CHECK(std::ranges::min(row) == scores[window]);
    }
  }
  // The result and its matrix have equal metrics: neither counts windows without scores.
  write_text("pairs.csv", "query,sequence,reference\n5,two,5\n6,two,6\n9,two,9\n");
  const auto metrics = [&](const std::string& more) {
    const std::string words = "vpr-eval r.json --ground-truth pairs.csv --json " + more;
    return printed_json(words)["metrics"]["single_best"];
  };
  const Json own = metrics("");
  const Json of_matrix = metrics("--matrix m.npy");
  CHECK(own["positives"] == of_matrix["positives"]);
  CHECK(own["average_precision"] == of_matrix["average_precision"]);
}

TEST_CASE("a query by margin recognizes the revisit, and vpr-eval supports either confidence") {
  start_with(make_walks);
  const Json json = printed_json(query("--decide margin --margin 400 -o r.json --json"));
  CHECK(json["settings"]["decide"] == "margin");
  CHECK(json["settings"]["margin"] == 400.0);
  CHECK_FALSE(json["settings"].contains("t_r"));
  CHECK(json["sequences"][1]["margin"] == 400.0);
  CHECK(json["totals"]["recognitions"] == 8);
  CHECK(json["files"].contains("margins"));
  const auto report = [&](const std::string& more) {
    return printed_json("vpr-eval r.json --ground-truth truth.csv --json " + more);
  };
  const Json by_score = report("--confidence score");
  CHECK(by_score["counts"]["pairs"]["correct"] == 8);
  CHECK(by_score["counts"]["pairs"]["incorrect"] == 0);
  CHECK(by_score["metrics"]["by_margin"]["recall_at_100_precision"] >= 0.8);
  CHECK_FALSE(by_score.contains("confidence"));
  const Json by_margin = report("--html page.html");  // the decision of the result
  CHECK(by_margin["confidence"] == "margin");
  CHECK(by_margin["protocol"]["pairs"] ==
        "best matches with a distance better than the runner-up by at least the margin");
  CHECK(by_margin["metrics"]["single_best"] == by_score["metrics"]["by_margin"]);
  CHECK(by_margin["metrics"]["by_score"]["average_precision"] ==
        by_score["metrics"]["single_best"]["average_precision"]);
  CHECK(by_margin["protocol"]["single_best"].get<std::string>().starts_with("a margin accepts"));
  const std::string html = read_text("page.html");
  CHECK(has(html, "required margin"));
  CHECK(has(html, "Recognitions by margin"));
  CHECK(has(html, "least margin in "));
  CHECK(has(html, "<label for=\"threshold\">Margin (line and circle)</label>"));
  CHECK(has(html, "\"asked\":400.0"));
  CHECK_FALSE(has(html, "below the threshold"));
  const auto table = run("vpr-eval r.json --ground-truth truth.csv -v");
  CHECK(has(table.out, " (by margin)\n"));
  CHECK(has(table.out, "best matches, by score"));
}

TEST_CASE("vpr-tune sweeps margins, and its recommendation is a query's settings") {
  start_with(make_walks);
  const Json json = printed_json(
      "vpr-tune fastable db.vprdb --query query --ground-truth truth.csv --c-l 3 --decide margin "
      "--margin 2,400:440:10 --save-config best.json --json");
  CHECK(json["cells"][0]["margin"] == 2.0);
  CHECK_FALSE(json["cells"][0].contains("t_r"));
  const Json config = Json::parse(read_text("best.json"));
  CHECK(config["decide"] == "margin");
  const Json found = printed_json("vpr-query db.vprdb --query query --config best.json --json");
  CHECK(found["totals"]["recognitions"] > 0);
}
