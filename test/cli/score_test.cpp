// Standardized scores as a user asks for them.
#include <algorithm>
#include <filesystem>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "base/npy.h"
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
      for (int i = 0; i < 12; ++i)
        test::write_image(folder / name / fmt::format("{:02}.png", i), ++seed);
    }
    for (int i = 4; i < 10; ++i)  // a revisit of the second walk
      fs::copy_file(folder / "two" / fmt::format("{:02}.png", i),
                    folder / "query" / fmt::format("{:02}.png", i),
                    fs::copy_options::overwrite_existing);
    REQUIRE(run_program("vpr-train", {"fastable", "--train", folder / "one", "--train",
                                      folder / "two", "--c-l", "3", "-o", database()})
                .exit_code == 0);
  }
  std::string database() const { return folder / "db.vprdb"; }
  test::RunOutcome query(std::vector<std::string> words) const {
    words.insert(words.begin(), {database(), "--query", folder / "query", "--c-l", "3"});
    return run_program("vpr-query", words);
  }
};

const Walks& walks() {
  static const Walks kShared;
  return kShared;
}

Json parse(const std::string& text) { return Json::parse(text); }

}  // namespace

TEST_CASE("negative thresholds on the command line, and what the result says of the scores") {
  const auto outcome =
      walks().query({"--score", "standardized", "--t-r", "-1.5", "--verify", "50", "--json"});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const Json json = parse(outcome.out);
  CHECK(json["settings"]["score"] == "standardized");
  CHECK(json["settings"]["t_r"] == -1.5);
  CHECK(json["settings"]["t_r_scale"] == "mean-z");
  CHECK(json["settings"]["standardization"]["forgetting"] == 0.98);
  CHECK(json["statistics"]["neighbour_frames"] == 5);
  CHECK(json["targets"][1]["limit"] == -3 * 1536);
  CHECK(json["totals"]["hits"] > 0);
  CHECK(json["verification"]["differences"] == 0);
  for (const Json& place : json["clusters"]) CHECK(place["best_score"] < -3 * 1536);
  CHECK(walks()
            .query({"--score", "standardized", "--t-r", "-1.5", "--t-r-scale", "mean-z", "--json"})
            .exit_code == 0);
}

TEST_CASE("scales and settings that mean nothing for a score are usage errors") {
  using Words = std::vector<std::string>;
  for (const Words& words :
       {Words{"--score", "standardized", "--t-r", "0.4", "--t-r-scale", "relative"},
        Words{"--score", "standardized", "--t-r", "200", "--t-r-scale", "bits"},
        Words{"--score", "standardized-offline", "--t-r", "200", "--t-r-scale", "bits"},
        Words{"--t-r", "-1", "--t-r-scale", "mean-z"}, Words{"--t-r", "-1"},
        Words{"--score", "standardized", "--method", "openable", "--t-r", "-1"},
        Words{"--score", "standardized", "--method", "lsh", "--t-r", "-1"},
        Words{"--score", "standardized", "--safety-factor", "0.9"},
        Words{"--score", "standardized"}, Words{"--score", "standardised"},
        Words{"--score", "standardized", "--max-memory", "10"}}) {
    Words all = words;
    all.emplace_back("--json");
    const auto outcome = walks().query(all);
    INFO(fmt::format("{}", outcome.err));
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
  }
}

TEST_CASE("every setting of standardized scores can stand in the configuration") {
  test::write_text(walks().folder / "c.json",
                   R"({"score": "standardized", "t_r": -1, "standardization": {"forgetting": 0.9,
                       "start_weight": 3, "deviation_floor": 20, "view_change": 0,
                       "lag_views": 1}})");
  const auto outcome =
      walks().query({"--config", walks().folder / "c.json", "--verify", "100", "--json"});
  REQUIRE(outcome.exit_code == 0);
  CHECK(parse(outcome.out)["settings"]["standardization"]["lag_views"] == 1);
  test::write_text(walks().folder / "t.json",
                   R"({"statistics": {"neighbour_frames": 2, "samples": 7, "seed": 3}})");
  REQUIRE(run_program("vpr-train",
                      {"fastable", "--train", walks().folder / "one", "--config",
                       walks().folder / "t.json", "-o", walks().folder / "s.vprdb", "--force"})
              .exit_code == 0);
  const Json manifest = parse(test::read_text(walks().folder / "s.vprdb/manifest.json"));
  CHECK(manifest["statistics"]["samples"] == 7);
  CHECK(manifest["statistics"]["seed"] == 3);
}

TEST_CASE("frames that can't be read have no score, and the matrix says so") {
  const test::TemporaryFolder folder;
  fs::copy(walks().folder / "query", folder / "query");
  test::write_text(folder / "query/05.png", "no image");
  REQUIRE(run_program("vpr-query",
                      {walks().database(), "--query", folder / "query", "--c-l", "3", "--score",
                       "standardized", "--t-r", "0", "--skip-unreadable", "--save-matrix",
                       folder / "m.npy", "--verify", "60", "-o", folder / "r.json"})
              .exit_code == 0);
  const NpyArray best(folder / "r.best.npy");
  const auto rows = best.values<int32_t>(2);
  const NpyArray score_file(folder / "r.best_scores.npy");
  const auto scores = score_file.values<double>(1);
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
  // The result and its matrix give the same metrics: windows without scores are in neither.
  test::write_text(folder / "pairs.csv", "query,sequence,reference\n5,two,5\n6,two,6\n9,two,9\n");
  const auto metrics = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {folder / "r.json", "--ground-truth", folder / "pairs.csv",
                                      "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return parse(run_program("vpr-eval", words).out)["metrics"]["single_best"];
  };
  const Json own = metrics({});
  const Json of_matrix = metrics({"--scores", folder / "m.npy"});
  CHECK(own["to_find"] == of_matrix["to_find"]);
  CHECK(own["average_precision"] == of_matrix["average_precision"]);
}

TEST_CASE("vpr-tune sweeps thresholds of scores") {
  test::write_text(walks().folder / "pairs.csv", "query,sequence,reference\n5,two,5\n6,two,6\n");
  const auto sweep = [](const std::string& truth, const std::string& thresholds) {
    return run_program(
        "vpr-tune",
        {"fastable", walks().database(), "--query", walks().folder / "query", "--score",
         "standardized", "--ground-truth", truth, "--c-l", "2,3", "--t-r", thresholds, "--json"});
  };
  const std::string pairs = walks().folder / "pairs.csv";
  CHECK(sweep("aligned", "-3:-1:1").exit_code == 2);  // aligned needs a single training sequence
  CHECK(sweep(pairs, "-3:-1:1,auto").exit_code == 2);
  const auto counted = sweep(pairs, "-3:-1:1");
  INFO(counted.err);
  REQUIRE(counted.exit_code == 0);
  const Json cells = parse(counted.out)["cells"];
  REQUIRE(cells.size() == 6);
  for (const Json& cell : cells) CHECK(cell["t_r_scale"] == "mean-z");
}
