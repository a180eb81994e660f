// vpr-tune as a user runs it.
#include <catch2/catch.hpp>

#include "base/json.h"
#include "cli/world.h"
#include "support.h"

using namespace vpr;
using test::run_program;
using test::world;
namespace fs = std::filesystem;

namespace {

Json parse(const std::string& text) { return Json::parse(text); }

std::vector<std::string> fastable(std::vector<std::string> more) {
  std::vector<std::string> words = {
      "fastable",       world().database(),    "--query", world().walk("back"),
      "--ground-truth", world().truth("back"), "--c-l",   "2,10:20:10",
      "--t-r",          "0.3:0.5:0.1,auto"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace

TEST_CASE("a sweep's counts are those of vpr-query and vpr-eval, one by one") {
  const test::TemporaryFolder out;
  REQUIRE(run_program("vpr-tune", fastable({"-o", out / "s.json"})).exit_code == 0);
  const Json cells = parse(test::read_text(out / "s.json"))["cells"];
  REQUIRE(cells.size() == 3 * 4);
  for (const Json& cell : cells) {
    const std::string t_r = cell["t_r"].is_string() ? "auto" : cell["t_r"].dump();
    REQUIRE(run_program("vpr-query",
                        {world().database(), "--query", world().walk("back"), "--c-l",
                         cell["c_l"].dump(), "--t-r", t_r, "--force", "-o", out / "r.json"})
                .exit_code == 0);
    const Json report = parse(
        run_program("vpr-eval", {out / "r.json", "--ground-truth", world().truth("back"), "--json"})
            .out);
    INFO(cell.dump());
    CHECK(cell["counts"] == report["counts"]);
    CHECK(cell["best_match"]["correct"] == report["best_match"]["correct"]);
  }
}

TEST_CASE("FAB-MAP's sweep has the counts of single queries, too") {
  const test::TemporaryFolder out;
  REQUIRE(run_program("vpr-tune", {"fabmap", world().fabmap(), "--query", world().walk("back"),
                                   "--ground-truth", "aligned", "--tolerance", "25", "--c-w", "1:3",
                                   "--t-p", "0.2,0.6,0.99", "-o", out / "s.json"})
              .exit_code == 0);
  const Json cells = parse(test::read_text(out / "s.json"))["cells"];
  REQUIRE(cells.size() == 9);
  uint64_t correct = 0;
  for (const Json& cell : cells) {
    REQUIRE(run_program("vpr-query", {world().fabmap(), "--query", world().walk("back"), "--c-w",
                                      cell["c_w"].dump(), "--t-p", cell["t_p"].dump(), "--force",
                                      "-o", out / "r.json"})
                .exit_code == 0);
    const Json report = parse(run_program("vpr-eval", {out / "r.json", "--ground-truth", "aligned",
                                                       "--tolerance", "25", "--json"})
                                  .out);
    CHECK(cell["counts"] == report["counts"]);
    correct += cell["counts"]["hits"]["correct"].get<uint64_t>();
  }
  CHECK(correct > 0);
}

TEST_CASE("a sweep is byte-identical for any number of threads") {
  const test::TemporaryFolder out;
  std::string first;
  for (const char* threads : {"1", "2", "5"}) {
    REQUIRE(
        run_program("vpr-tune", fastable({"--threads", threads, "--force", "-o", out / "s.json"}))
            .exit_code == 0);
    Json json = parse(test::read_text(out / "s.json"));
    json.erase("machine");
    json.erase("timing");
    if (first.empty()) first = json.dump();
    CHECK(json.dump() == first);
  }
}

TEST_CASE("the recommended setting is reported on another sequence") {
  const test::TemporaryFolder out;
  const auto outcome = run_program(
      "vpr-tune",
      fastable({"--validate", world().walk("again"), "--validate-ground-truth",
                world().truth("again"), "--heat-map", out / "h.png", "-o", out / "s.json"}));
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.out.find("recommended: c_l") != std::string::npos);
  CHECK(outcome.err.find("not seen") == std::string::npos);
  const Json query = parse(test::read_text(out / "s.json"))["queries"][0];
  CHECK(query["validation"]["query"] == "again");
  CHECK(query["intervals"]["correct_hits"][0] <= query["intervals"]["correct_hits"][1]);
  CHECK(test::read_text(out / "h.png").substr(1, 3) == "PNG");
  const auto same = run_program(
      "vpr-tune", fastable({"--validate", world().walk("back"), "--validate-ground-truth",
                            world().truth("back"), "--json"}));
  CHECK(same.exit_code == 0);
  CHECK(same.err.find("not seen") != std::string::npos);
}

TEST_CASE("automatic thresholds are listed with their frames, and kept with --write") {
  const test::TemporaryFolder out;
  fs::copy(world().database(), out / "w.vprdb");
  const auto outcome =
      run_program("vpr-tune", {"threshold", out / "w.vprdb", "--c-l", "5,10", "--write", "--json"});
  REQUIRE(outcome.exit_code == 0);
  const Json thresholds = parse(outcome.out)["thresholds"];
  REQUIRE(thresholds.size() == 4);
  const Json info = parse(run_program("vpr-train", {"info", out / "w.vprdb", "--json"}).out);
  for (const Json& t_r : info["sequences"][0]["t_r"])
    for (const Json& item : thresholds)
      if (item["sequence"] == info["sequences"][0]["name"] && item["c_l"] == t_r["c_l"])
        CHECK(item["t_r"] == t_r["bits"]);
  CHECK(info["sequences"][0]["t_r"].size() == 2);
}

TEST_CASE("lists and ranges of vpr-tune") {
  const auto check = [&](const std::string& c_l, const std::string& t_r, int exit_code) {
    const auto outcome =
        run_program("vpr-tune", {"fastable", world().database(), "--query", world().walk("back"),
                                 "--ground-truth", world().truth("back"), "--c-l", c_l, "--t-r",
                                 t_r, "--json"});
    INFO(c_l << " " << t_r << ": " << outcome.err);
    CHECK(outcome.exit_code == exit_code);
    return outcome.out;
  };
  CHECK(parse(check("5", "auto", 0))["cells"].size() == 1);
  CHECK(parse(check("5", "auto,0.3", 0))["cells"].size() == 2);
  CHECK(parse(check("5", "0.3,auto,0.4,auto", 0))["cells"].size() == 3);
  CHECK(parse(check("5,5,4:5", "0.2:0.4:0.1,0.3", 0))["cells"].size() == 2 * 3);
  CHECK(parse(check("5", "0.1:0.9:0.2", 0))["cells"][4]["t_r"] == 0.9);
  for (const char* wrong : {"x", "0", "2.5", "5:1", "1:5:0", "1:2:3:4", "5,,6", "99999"})
    check(wrong, "0.3", 2);
  for (const char* wrong : {"x", "0.5:0.1:0.1", "-1", "nan", "0.2auto", "auto0.2", "autos", ",auto",
                            "automatic", "0.2,,auto"})
    check("5", wrong, 2);
}

TEST_CASE("a batch of data sets is written whole or not at all, beside whatever stands there") {
  const test::TemporaryFolder out;
  const auto dataset = [&](const std::string& name) {
    test::write_text(
        out / (name + ".json"),
        R"({"schema": "vpr.dataset/1", "name": ")" + name + R"(", "queries": [{"name": ")" + name +
            R"(", "sequence": ")" + world().walk(name) +
            R"(", "ground_truth": {"format": "pairs", "path": ")" + name + R"(.csv"}}]})");
    return std::string(out / (name + ".json"));
  };
  const auto run = [&](const std::string& output) {
    return run_program("vpr-tune",
                       {"fastable", world().database(), "--dataset", dataset("back"), "--dataset",
                        dataset("again"), "--c-l", "5,10", "--t-r", "0.3,0.4", "-o", out / output})
        .exit_code;
  };
  fs::copy(world().truth("back"), out / "back.csv");
  test::write_text(out / "again.csv", "broken");
  test::write_text(out / "s.json.partial", "the user's own");
  CHECK(run("s.json") == 4);
  CHECK(!fs::exists(out / "s.json"));
  fs::copy(world().truth("again"), out / "again.csv", fs::copy_options::overwrite_existing);
  CHECK(run("s.json") == 0);
  CHECK(test::read_text(out / "s.json.partial") == "the user's own");
  const Json sweep = parse(test::read_text(out / "s.json"));
  REQUIRE(sweep["queries"].size() == 2);
  CHECK(sweep["queries"][1]["name"] == "again");
  CHECK(sweep["cells"].size() == 2 * 2 * 2);
}

TEST_CASE("vpr-tune chooses without a grid or an output, and vpr-query takes its choice") {
  const test::TemporaryFolder out;
  const std::vector<std::string> data = {"--query", world().walk("back"), "--ground-truth",
                                         world().truth("back")};
  const auto run = [&](const std::string& family, const std::string& database,
                       std::vector<std::string> more) {
    std::vector<std::string> words = {family, database};
    words.insert(words.end(), data.begin(), data.end());
    words.insert(words.end(), more.begin(), more.end());
    return run_program("vpr-tune", words);
  };
  const auto plain = run("fastable", world().database(), {});
  REQUIRE(plain.exit_code == 0);
  CHECK(plain.out.find("hits by t_r and c_l (* recommended)") != std::string::npos);
  CHECK(plain.out.find("vpr-query " + world().database()) != std::string::npos);
  const auto saved =
      run("fastable", world().database(), {"--save-config", out / "c.json", "-o", out / "s.json"});
  REQUIRE(saved.exit_code == 0);
  CHECK(saved.out.find("--config " + std::string(out / "c.json")) != std::string::npos);
  const Json sweep = parse(test::read_text(out / "s.json"));
  Json settings = sweep["queries"][0]["recommended_settings"];
  Json config = parse(test::read_text(out / "c.json"));
  CHECK(config["schema"] == "vpr.config/1");
  config.erase("schema");
  CHECK(config == settings);
  const Json cell = sweep["cells"][sweep["queries"][0]["recommended"].get<size_t>()];
  CHECK(settings["c_l"] == cell["c_l"]);
  CHECK(cell["counts"]["hits"]["incorrect"] == 0);
  // The counts of the recommended cell, from the file alone.
  REQUIRE(run_program("vpr-query", {world().database(), "--query", world().walk("back"), "--config",
                                    out / "c.json", "-o", out / "r.json"})
              .exit_code == 0);
  const Json report = parse(
      run_program("vpr-eval", {out / "r.json", "--ground-truth", world().truth("back"), "--json"})
          .out);
  CHECK(report["counts"] == cell["counts"]);
  CHECK(report["settings"] == settings);
}

TEST_CASE("without a recommendation there is no configuration, and the exit code says so") {
  const test::TemporaryFolder out;
  const auto outcome =
      run_program("vpr-tune", {"fastable", world().database(), "--query", world().walk("back"),
                               "--ground-truth", world().truth("back"), "--c-l", "5", "--t-r",
                               "0.01,0.02", "--save-config", out / "c.json", "-o", out / "s.json"});
  CHECK(outcome.exit_code == 5);
  CHECK(outcome.err.find("no setting has a hit") != std::string::npos);
  CHECK(outcome.err.find("use --method filter") != std::string::npos);
  CHECK(outcome.err.find("longer c_l") == std::string::npos);
  CHECK(test::list_folder(out.path()) == std::vector<std::string>{"s.json"});
  const Json query = parse(test::read_text(out / "s.json"))["queries"][0];
  CHECK(query["advice"] == "no_hits");
  CHECK((query["recommended"].is_null() && query["recommended_settings"].is_null()));
}

TEST_CASE("FAB-MAP has a default grid and a configuration, too") {
  const test::TemporaryFolder out;
  const auto outcome = run_program(
      "vpr-tune", {"fabmap", world().fabmap(), "--query", world().walk("back"), "--ground-truth",
                   "aligned", "--tolerance", "25", "--format", "csv", "-o", out / "s.json"});
  REQUIRE(outcome.exit_code == 0);
  const Json sweep = parse(test::read_text(out / "s.json"));
  CHECK(sweep["cells"].size() == 5 * 10);
  CHECK(std::count(outcome.out.begin(), outcome.out.end(), '\n') == 1 + 5 * 10);
  CHECK(outcome.out.find("query,c_w,t_p,scale,hits_correct,hits_incorrect") == 0);
}

TEST_CASE("a validation may be another query of the data set, by its name") {
  const test::TemporaryFolder out;
  const auto query = [&](const std::string& name) {
    return Json{{"name", name},
                {"sequence", world().walk(name)},
                {"ground_truth", {{"format", "pairs"}, {"path", world().truth(name)}}}};
  };
  const Json dataset = {
      {"schema", "vpr.dataset/1"}, {"name", "both"}, {"queries", {query("back"), query("again")}}};
  test::write_text(out / "d.json", dataset.dump());
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"fastable",     world().database(), "--dataset",
                                      out / "d.json", "--query",          "back"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program("vpr-tune", words);
  };
  const auto outcome = run({"--validate", "again"});
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.out.find("On again: hits ") != std::string::npos);
  CHECK(outcome.out.find("{") == std::string::npos);
  CHECK(run({"--validate", "nobody"}).exit_code == 2);
  CHECK(run({"--validate-ground-truth", world().truth("again")}).exit_code == 2);
}
