// vpr-eval compare as a paper's author runs it.
#include <algorithm>
#include <filesystem>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "base/npy.h"
#include "cli/world.h"
#include "support.h"

using namespace vpr;
using test::run_program;
using test::world;

namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Ten queries against ten references, aligned; the first `right` are right, the closer the
/// earlier, all others prefer reference 0.
std::string report_of(const test::TemporaryFolder& folder, const std::string& name, size_t right) {
  std::vector<float> scores(100, 50);
  for (size_t q = 0; q < 10; ++q) scores[q < right ? 11 * q : 10 * q] = float(q + 1);
  Output file(folder / (name + ".npy"), Existing::replace);
  write_npy<float>(file, scores, {10, 10});
  file.commit();
  const std::string report = folder / (name + ".json");
  REQUIRE(run_program("vpr-eval", {"--scores", folder / (name + ".npy"), "--distance",
                                   "--ground-truth", "aligned", "-o", report, "--quiet"})
              .exit_code == 0);
  return report;
}

}  // namespace

TEST_CASE("the table of a paper has a row for each method, and the best in bold") {
  const test::TemporaryFolder folder;
  const std::string good = report_of(folder, "good", 8);
  const std::string bad = report_of(folder, "bad", 4);
  const auto table = [&](const std::string& format) {
    const auto run = run_program("vpr-eval", {"compare", good, bad, "--name", "ours & yours",
                                              "--name", "theirs", "--format", format});
    CHECK(run.err.empty());
    REQUIRE(run.exit_code == 0);
    return run.out;
  };
  // Of ten to find 8 are right, and the first 8 accepted ones: AP = R@100P = 0.8, and max F1 =
  // 16 / (8 + 10). R@5 and R@10 count rank ties to the first.
  const std::string text = table("text");
  CHECK(has(text, "ours & yours  0.8000*"));
  CHECK(has(text, "0.8889*"));
  CHECK(has(text, "theirs        0.4000 "));
  CHECK(has(text, "share, wrong and longest gap (frames)"));
  CHECK(has(table("latex"), "ours \\& yours & \\textbf{0.8000}"));
  CHECK(has(table("latex"), "\\label{tab:queries-over-10-common-queries"));
  CHECK(has(table("markdown"), "| theirs | 0.4000 |"));
  const std::string csv = table("csv");
  CHECK(csv.rfind("query,report,walk,ground_truths,metric,value,difference,low,high,verdict\n",
                  0) == 0);
  CHECK(has(csv, "queries,theirs,,same,recall_at_1,0.4,-0.4,"));
  CHECK(has(csv, "queries,theirs,,same,longest_gap_frames,6,"));
  CHECK(run_program("vpr-eval", {"compare", good, bad, "--name", "one"}).exit_code == 2);
}

TEST_CASE("curves and paths of all methods are on one page and in one plot") {
  const test::TemporaryFolder folder;
  const auto run = run_program(
      "vpr-eval", {"compare", report_of(folder, "<good>", 8), report_of(folder, "bad", 4), "--html",
                   folder / "c.html", "--plot", folder / "plots"});
  REQUIRE(run.exit_code == 0);
  const std::string page = test::read_text(folder / "c.html");
  CHECK(has(
      page,
      "Best matches of the 10 common queries are right in 80.0 % by &lt;good&gt;, 40.0 % by bad."));
  CHECK(has(page, "<b>0.8000</b>"));
  CHECK(has(page, "class=\"line series-1\""));
  CHECK(has(page, "<svg class=\"lanes\""));
  CHECK_FALSE(has(page, "http:"));
  CHECK(test::list_folder(folder / "plots") ==
        std::vector<std::string>{".vpr-files", "lanes.png", "lanes.svg", "precision-recall.png",
                                 "precision-recall.svg"});
}

TEST_CASE("a replayed query stands beside the query, over its own frames") {
  const test::TemporaryFolder out;
  const auto evaluate = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words = {
        world().database(),      "--dataset", world().dataset(), "--c-l", "1", "--t-r", "0.3", "-o",
        out / (name + ".r.json")};
    words.insert(words.end(), more.begin(), more.end());
    REQUIRE(run_program("vpr-query", words).exit_code == 0);
    REQUIRE(run_program("vpr-eval", {out / (name + ".r.json"), "--dataset", world().dataset(), "-o",
                                     out / (name + ".json"), "--quiet"})
                .exit_code == 0);
    return std::string(out / (name + ".json"));
  };
  const std::string plain = evaluate("plain", {});
  const std::string slow = evaluate("slow", {"--warp", "0.5"});
  const auto run = run_program("vpr-eval", {"compare", plain, slow, "--json"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Json found = Json::parse(run.out);
  CHECK(found["ground_truths"] == "same");
  CHECK(found["reports"][1]["paired"] == false);
  CHECK(found["reports"][1]["walk"] == "replayed: 0.5, seed 1");
  CHECK(found["reports"][1]["queries"] == 2 * found["reports"][0]["queries"].get<int>());
  CHECK(found["paired"].empty());
  // Every frame is shown twice: the shares are the same.
  CHECK(found["metrics"][1]["value"] == found["metrics"][0]["value"]);
  CHECK(found["metrics"][1]["difference"] == 0);
  CHECK(found["metrics"][1]["low"].is_null());
  CHECK(has(run_program("vpr-eval", {"compare", plain, slow}).out, "not paired, over"));
  // Replays that are the same are paired.
  CHECK(test::printed_json(run_program("vpr-eval", {"compare", slow, slow, "--json"}))["paired"]
            .size() == 1);
}
