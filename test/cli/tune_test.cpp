// vpr-tune on a small world.
#include <catch2/catch.hpp>

#include "base/text.h"
#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

Words fastable(Words more) {
  Words words =
      joined({"fastable", world().database(), "--query", world().walk("back"), "--ground-truth",
              world().truth("back"), "--c-l", "2,10:20:10", "--t-r", "0.3:0.5:0.1,auto"},
             more);
  return words;
}

Words calibrate(Words more, std::string truth = "") {
  if (truth.empty()) truth = world().truth("back");
  return joined({"calibrate", world().database(), "--query", world().walk("back"), "--ground-truth",
                 truth, "--c-l", "5,10"},
                more);
}

Json query_with(const std::string& config, const TemporaryFolder& out) {
  run_ok("vpr-query", {world().database(), "--query", world().walk("back"), "--config", config,
                       "--force", "-o", out / "r.json"});
  return printed_json("vpr-eval",
                      {out / "r.json", "--ground-truth", world().truth("back"), "--json"});
}

Words trial(const std::string& walk, Words more = {}) {
  return joined(
      {world().database(), "--query", world().walk(walk), "--ground-truth", world().truth("back")},
      more);
}

// A result on a terminal: at most 12 lines of 80 columns, except lines that are a single word.
void check_terminal(const std::string& text, size_t most_lines = 12) {
  INFO(text);
  const Words lines = lines_of(text);
  CHECK(lines.size() <= most_lines);
  for (const std::string& line : lines) {
    const size_t word = line.find_first_not_of(' ');
    CHECK((line.size() <= 80 || line.find(' ', word) == line.rfind(" \\")));
  }
}

// The words of the command at the end of a text, without the quotes of a shell.
Words command_of(const std::string& text) {
  Words words;
  std::string joined = text.substr(text.find("  vpr-query "));
  for (size_t at = 0; (at = joined.find(" \\\n")) != std::string::npos;) joined.erase(at, 3);
  const std::string command = lines_of(joined).front();
  for (const std::string_view word : split_words(command)) words.emplace_back(word);
  words.erase(words.begin());
  return words;
}

}  // namespace

TEST_CASE("the choice has the frames of vpr-query and vpr-eval with the printed command") {
  const TemporaryFolder out;
  const auto outcome = run_ok("vpr-tune", trial("back", {"-v", "-o", out / "t.json"}));
  const Json tuning = file_json(out / "t.json");
  REQUIRE(tuning["trials"].size() == 4);
  CHECK(tuning["trials"][0]["settings"]["method"] == "filter");
  CHECK(tuning["trials"][1]["settings"]["score"] == "zscore");
  CHECK(tuning["trials"][2]["settings"]["rates"].size() == 5);
  CHECK(tuning["trials"][3]["settings"]["t_r"].is_number());
  for (const Json& one : tuning["trials"]) {
    const std::string name = one["name"];
    INFO(name);
    const size_t at = outcome.out.find("\n" + name + ":\n");
    REQUIRE(at != std::string::npos);
    Words words = command_of(outcome.out.substr(at));
    REQUIRE(words.back() == "result.json");
    words.back() = out / "r.json";
    words.emplace_back("--force");
    run_ok("vpr-query", words);
    const Json report = printed_json(
        "vpr-eval", {out / "r.json", "--ground-truth", world().truth("back"), "--json"});
    CHECK(report["settings"] == one["settings"]);
    CHECK(report["localization"]["correct"] == one["correct"]);
    CHECK(report["localization"]["incorrect"] == one["incorrect"]);
  }
  const Json& chosen = tuning["trials"][tuning["chosen"].get<size_t>()];
  CHECK(chosen["incorrect"] == 0);
  for (const Json& one : tuning["trials"])
    if (one["incorrect"] == 0) CHECK(one["correct"] <= chosen["correct"]);
  CHECK(tuning["settings"] == chosen["settings"]);
  check_terminal(run_ok("vpr-tune", trial("back")).out);
}

TEST_CASE("the choice is a configuration, and is the same for any number of threads") {
  const TemporaryFolder out;
  std::vector<Json> all;
  for (const char* threads : {"1", "3"}) {
    run_ok("vpr-tune", trial("back", {"--threads", threads, "-o", out / "t.json", "--save-config",
                                      out / "c.json", "--force"}));
    all.push_back(file_json(out / "t.json"));
    all.back().erase("machine");
    all.back().erase("timing");
  }
  CHECK(all[0] == all[1]);
  Json config = file_json(out / "c.json");
  config.erase("schema");
  CHECK(config == all[0]["settings"]);
  for (const char* file : {"c.json", "t.json"})
    CHECK(query_with(out / file, out)["settings"] == all[0]["settings"]);
}

TEST_CASE("without a correct frame there is no choice, no command and no configuration") {
  const TemporaryFolder out;
  write_text(out / "wrong.csv", "query,sequence,reference\n20,one,0\n21,one,0\n22,two,0\n");
  const auto outcome = run_program(
      "vpr-tune", {world().database(), "--query", world().walk("back"), "--ground-truth",
                   out / "wrong.csv", "--save-config", out / "c.json"});
  CHECK(outcome.exit_code == 5);
  CHECK(has(outcome.out, "no setting recognizes a frame correctly"));
  CHECK(has(outcome.out, "Check the ground truth."));
  CHECK_FALSE(has(outcome.out, "vpr-query"));
  CHECK(!fs::exists(out / "c.json"));
  check_failure("vpr-tune", {"--query", "x"}, 2, "the database is missing");
}

TEST_CASE("FAB-MAP is tried with its database") {
  const TemporaryFolder out;
  run_ok("vpr-train", {"fastable", "--train", world().walk("one"), "-o", out / "one.vprdb"});
  const Json tuning = printed_json(
      "vpr-tune", {out / "one.vprdb", "--query", world().walk("back"), "--ground-truth", "aligned",
                   "--tolerance", "25", "--fabmap", world().fabmap(), "--json"});
  REQUIRE(tuning["trials"].size() == 5);
  CHECK(tuning["trials"][4]["settings"]["method"] == "fabmap");
  CHECK(tuning["trials"][4]["correct"].get<uint64_t>() > 0);
}

TEST_CASE("a sweep has the counts of vpr-query and vpr-eval") {
  const TemporaryFolder out;
  run_ok("vpr-tune", fastable({"-o", out / "s.json"}));
  const Json cells = file_json(out / "s.json")["cells"];
  REQUIRE(cells.size() == 3 * 4);
  for (const Json& cell : cells) {
    const std::string t_r = cell["t_r"].is_string() ? "auto" : cell["t_r"].dump();
    run_ok("vpr-query", {world().database(), "--query", world().walk("back"), "--c-l",
                         cell["c_l"].dump(), "--t-r", t_r, "--force", "-o", out / "r.json"});
    const Json report = printed_json(
        "vpr-eval", {out / "r.json", "--ground-truth", world().truth("back"), "--json"});
    INFO(cell.dump());
    CHECK(cell["counts"] == report["counts"]);
    CHECK(cell["best_match"]["correct"] == report["best_match"]["correct"]);
  }
}

TEST_CASE("FAB-MAP's sweep has the counts of single queries as well") {
  const TemporaryFolder out;
  run_ok("vpr-tune",
         {"fabmap", world().fabmap(), "--query", world().walk("back"), "--ground-truth", "aligned",
          "--tolerance", "25", "--c-w", "1:3", "--t-p", "0.2,0.6,0.99", "-o", out / "s.json"});
  const Json cells = file_json(out / "s.json")["cells"];
  REQUIRE(cells.size() == 9);
  uint64_t correct = 0;
  for (const Json& cell : cells) {
    run_ok("vpr-query",
           {world().fabmap(), "--query", world().walk("back"), "--c-w", cell["c_w"].dump(), "--t-p",
            cell["t_p"].dump(), "--force", "-o", out / "r.json"});
    const Json report = printed_json(
        "vpr-eval", {out / "r.json", "--ground-truth", "aligned", "--tolerance", "25", "--json"});
    CHECK(cell["counts"] == report["counts"]);
    correct += cell["counts"]["pairs"]["correct"].get<uint64_t>();
  }
  CHECK(correct > 0);
}

TEST_CASE("a sweep fits a terminal, and commands repeat the selection of frames") {
  check_terminal(run_ok("vpr-tune", fastable({"--speed", "2"})).out, 12 + 5);
  CHECK(has(run_ok("vpr-tune", trial("back", {"--speed", "2"})).out, "--speed 2"));
}

TEST_CASE("a sweep is byte-identical for any number of threads") {
  const TemporaryFolder out;
  std::string first;
  for (const char* threads : {"1", "2", "5"}) {
    run_ok("vpr-tune", fastable({"--threads", threads, "--force", "-o", out / "s.json"}));
    Json json = file_json(out / "s.json");
    json.erase("machine");
    json.erase("timing");
    if (first.empty()) first = json.dump();
    CHECK(json.dump() == first);
  }
}

TEST_CASE("the recommended setting is reported for another sequence") {
  const TemporaryFolder out;
  const auto outcome =
      run_ok("vpr-tune",
             fastable({"--validate", world().walk("again"), "--validate-ground-truth",
                       world().truth("again"), "--heat-map", out / "h.png", "-o", out / "s.json"}));
  CHECK(has(outcome.out, "Recommended: c_l"));
  CHECK_FALSE(has(outcome.err, "not seen"));
  const Json query = file_json(out / "s.json")["queries"][0];
  CHECK(query["validation"]["query"] == "again");
  CHECK(query["intervals"]["correct_recognitions"][0] <=
        query["intervals"]["correct_recognitions"][1]);
  CHECK(read_text(out / "h.png").substr(1, 3) == "PNG");
  const auto same =
      run_ok("vpr-tune", fastable({"--validate", world().walk("back"), "--validate-ground-truth",
                                   world().truth("back"), "--json"}));
  CHECK(has(same.err, "not seen"));
}

TEST_CASE("automatic thresholds are listed with their frames, and stored with --write") {
  const TemporaryFolder out;
  fs::copy(world().database(), out / "w.vprdb");
  const Json thresholds = printed_json("vpr-tune", {"threshold", out / "w.vprdb", "--c-l", "5,10",
                                                    "--write", "--json"})["thresholds"];
  REQUIRE(thresholds.size() == 4);
  const Json info = printed_json("vpr-train", {"info", out / "w.vprdb", "--json"});
  for (const Json& t_r : info["sequences"][0]["t_r"])
    for (const Json& item : thresholds)
      if (item["sequence"] == info["sequences"][0]["name"] && item["c_l"] == t_r["c_l"])
        CHECK(item["t_r"] == t_r["bits"]);
  CHECK(info["sequences"][0]["t_r"].size() == 2);
}

TEST_CASE("lists and ranges of vpr-tune are checked") {
  const auto check = [&](const std::string& c_l, const std::string& t_r, int exit_code) {
    const auto outcome =
        run_program("vpr-tune", {"fastable", world().database(), "--query", world().walk("back"),
                                 "--ground-truth", world().truth("back"), "--c-l", c_l, "--t-r",
                                 t_r, "--json"});
    INFO(c_l << " " << t_r << ": " << outcome.err);
    CHECK(outcome.exit_code == exit_code);
    return outcome.out;
  };
  CHECK(Json::parse(check("5", "auto", 0))["cells"].size() == 1);
  CHECK(Json::parse(check("5", "auto,0.3", 0))["cells"].size() == 2);
  CHECK(Json::parse(check("5", "0.3,auto,0.4,auto", 0))["cells"].size() == 3);
  CHECK(Json::parse(check("5,5,4:5", "0.2:0.4:0.1,0.3", 0))["cells"].size() == 2 * 3);
  CHECK(Json::parse(check("5", "0.1:0.9:0.2", 0))["cells"][4]["t_r"] == 0.9);
  for (const char* wrong : {"x", "0", "2.5", "5:1", "1:5:0", "1:2:3:4", "5,,6", "99999"})
    check(wrong, "0.3", 2);
  for (const char* wrong : {"x", "0.5:0.1:0.1", "-1", "nan", "0.2auto", "auto0.2", "autos", ",auto",
                            "automatic", "0.2,,auto"})
    check("5", wrong, 2);
}

TEST_CASE("a batch of data sets is written completely or not at all, next to other files") {
  const TemporaryFolder out;
  const auto dataset = [&](const std::string& name) {
    write_text(out / (name + ".json"),
               R"({"schema": "vpr.dataset/3", "name": ")" + name + R"(", "queries": [{"name": ")" +
                   name + R"(", "sequence": ")" + world().walk(name) +
                   R"(", "ground_truth": {"format": "pairs", "path": ")" + name + R"(.csv"}}]})");
    return (out / (name + ".json")).string();
  };
  const auto run = [&](const std::string& output) {
    return run_program("vpr-tune",
                       {"fastable", world().database(), "--dataset", dataset("back"), "--dataset",
                        dataset("again"), "--c-l", "5,10", "--t-r", "0.3,0.4", "-o", out / output})
        .exit_code;
  };
  fs::copy(world().truth("back"), out / "back.csv");
  write_text(out / "again.csv", "broken");
  write_text(out / "s.json.partial", "the user's own");
  CHECK(run("s.json") == 4);
  CHECK(!fs::exists(out / "s.json"));
  fs::copy(world().truth("again"), out / "again.csv", fs::copy_options::overwrite_existing);
  CHECK(run("s.json") == 0);
  CHECK(read_text(out / "s.json.partial") == "the user's own");
  const Json sweep = file_json(out / "s.json");
  REQUIRE(sweep["queries"].size() == 2);
  CHECK(sweep["queries"][1]["name"] == "again");
  CHECK(sweep["cells"].size() == 2 * 2 * 2);
}

TEST_CASE("vpr-tune chooses without a grid or an output, and vpr-query accepts its choice") {
  const TemporaryFolder out;
  const auto run = [&](const Words& more) {
    return run_program("vpr-tune",
                       joined({"fastable", world().database(), "--query", world().walk("back"),
                               "--ground-truth", world().truth("back")},
                              more));
  };
  const auto plain = ok(run({}));
  CHECK_FALSE(has(plain.out, "accepted pairs by t_r and c_l"));
  CHECK(plain.out.starts_with("back: best t_r of each c_l, over "));
  check_terminal(plain.out, 12 + 5);  // 5 window lengths
  CHECK(has(ok(run({"-v"})).out, "accepted pairs by t_r and c_l (* recommended)"));
  CHECK(has(plain.out, "vpr-query " + world().database()));
  const auto saved = ok(run({"--save-config", out / "c.json", "-o", out / "s.json"}));
  CHECK(has(saved.out, "--config " + (out / "c.json").string()));
  const Json sweep = file_json(out / "s.json");
  Json settings = sweep["queries"][0]["recommended_settings"];
  Json config = file_json(out / "c.json");
  CHECK(config["schema"] == "vpr.config/3");
  config.erase("schema");
  CHECK(config == settings);
  const Json cell = sweep["cells"][sweep["queries"][0]["recommended"].get<size_t>()];
  CHECK(settings["c_l"] == cell["c_l"]);
  CHECK(cell["counts"]["pairs"]["incorrect"] == 0);
  // The counts of the recommended cell, from the file alone.
  run_ok("vpr-query", {world().database(), "--query", world().walk("back"), "--config",
                       out / "c.json", "-o", out / "r.json"});
  const Json report =
      printed_json("vpr-eval", {out / "r.json", "--ground-truth", world().truth("back"), "--json"});
  CHECK(report["counts"] == cell["counts"]);
  CHECK(report["settings"] == settings);
}

TEST_CASE("without a recommendation there is no configuration, and the exit code reports it") {
  const TemporaryFolder out;
  const auto outcome =
      run_program("vpr-tune", {"fastable", world().database(), "--query", world().walk("back"),
                               "--ground-truth", world().truth("back"), "--c-l", "5", "--t-r",
                               "0.01,0.02", "--save-config", out / "c.json", "-o", out / "s.json"});
  CHECK(outcome.exit_code == 5);
  CHECK(has(outcome.err, "no setting recognizes a frame"));
  CHECK(has(outcome.out, "The filter recognizes "));
  CHECK(list_folder(out.path()) == Words{"s.json"});
  const Json query = file_json(out / "s.json")["queries"][0];
  CHECK(query["advice"] == "no_recognitions");
  CHECK((query["recommended"].is_null() && query["recommended_settings"].is_null()));
}

TEST_CASE("FAB-MAP has a default grid and a configuration as well") {
  const TemporaryFolder out;
  const auto outcome = run_ok(
      "vpr-tune", {"fabmap", world().fabmap(), "--query", world().walk("back"), "--ground-truth",
                   "aligned", "--tolerance", "25", "--format", "csv", "-o", out / "s.json"});
  const Json sweep = file_json(out / "s.json");
  CHECK(sweep["cells"].size() == 5 * 10);
  CHECK(std::count(outcome.out.begin(), outcome.out.end(), '\n') == 1 + 5 * 10);
  CHECK(outcome.out.starts_with("query,c_w,t_p,scale,pairs_correct,pairs_incorrect"));
}

TEST_CASE("the validation may be another query of the data set, selected by name") {
  const TemporaryFolder out;
  const auto query = [&](const std::string& name) {
    return Json{{"name", name},
                {"sequence", world().walk(name)},
                {"ground_truth", {{"format", "pairs"}, {"path", world().truth(name)}}}};
  };
  const Json dataset = {
      {"schema", "vpr.dataset/3"}, {"name", "both"}, {"queries", {query("back"), query("again")}}};
  write_text(out / "d.json", dataset.dump());
  const auto run = [&](Words more) {
    return run_program("vpr-tune", joined({"fastable", world().database(), "--dataset",
                                           out / "d.json", "--query", "back"},
                                          more));
  };
  const auto outcome = ok(run({"--validate", "again"}));
  CHECK(has(outcome.out, "On again: "));
  CHECK_FALSE(has(outcome.out, "{"));
  CHECK(run({"--validate", "nobody"}).exit_code == 2);
  CHECK(run({"--validate-ground-truth", world().truth("again")}).exit_code == 2);
}

TEST_CASE("vpr-query with a calibration as configuration has its recognitions") {
  const TemporaryFolder out;
  for (const Words& more : {Words{}, {"--score", "raw"}, {"--method", "filter"}}) {
    const Words words =
        joined(calibrate({"-o", out / "c.json", "--force", "--fps", "4", "--json"}), more);
    const Json calibration = printed_json("vpr-tune", words);
    CHECK(file_json(out / "c.json") == calibration);
    const size_t chosen = calibration["chosen"];
    const Json& recognized = calibration["lengths"][chosen]["recognized"];
    CHECK(recognized["incorrect"] == 0);
    const Json recognitions = query_with(out / "c.json", out)["counts"]["pairs"];
    CHECK(recognitions["incorrect"] == 0);
    CHECK(recognitions["correct"] == recognized["correct"]);
    const double windows = calibration["lengths"][chosen]["windows"];
    const Json& interval = calibration["lengths"][chosen]["false_recognitions"]["interval"];
    CHECK(calibration["in_an_hour"]["interval"][1].get<double>() ==
          Approx(interval[1].get<double>() * 4 * 3600 / windows));
  }
}

TEST_CASE("a calibration is the same for any number of threads, except machine and timing") {
  std::vector<Json> found;
  for (const char* threads : {"1", "3"}) {
    found.push_back(printed_json("vpr-tune", calibrate({"--threads", threads, "--json"})));
    found.back().erase("machine");
    found.back().erase("timing");
  }
  CHECK(found[0] == found[1]);
}

TEST_CASE("impossible calibrations are refused with a sentence") {
  const TemporaryFolder out;
  const auto fails = [&](Words more, int exit_code, const std::string& words) {
    check_failure("vpr-tune", calibrate(std::move(more)), exit_code, words);
  };
  fails({"--target-precision", "0"}, 2, "precision must be above 0 and at most 1, found 0");
  fails({"--fps", "0"}, 2, "--fps must be above 0");
  fails({"--method", "lsh", "--score", "raw"}, 2,
        "vpr-tune calibrate does not go with --method lsh");
  write_text(out / "raw.json", R"({"c_l": 5, "t_r": -1.5})");
  fails({"--config", out / "raw.json"}, 2, "--t-r does not go with --decide margin");
  write_text(out / "fused.json", R"({"score": "zscore", "fusion_weight": 0.2})");
  fails({"--config", out / "fused.json"}, 2, "--fuse does not go with vpr-tune calibrate");
  write_text(out / "none.csv", "query,sequence,reference,label\n0,one,0,ignore\n");
  check_failure("vpr-tune", calibrate({}, out / "none.csv"), 2,
                "shows no trained place according to the ground truth");
  check_failure("vpr-tune", {"calibrate", world().database(), "--query", world().walk("back")}, 2,
                "pass --query and --ground-truth");
  check_failure("vpr-tune",
                {"calibrate", world().database(), "--query", world().walk("back") + "@0:1",
                 "--ground-truth", "aligned"},
                2, "not 10 consecutive readable ones");
  write_text(out / "wrong.csv", "query,sequence,reference\n20,one,0\n21,one,0\n22,two,0\n");
  const auto wrong = run_program("vpr-tune", calibrate({"-o", out / "c.json"}, out / "wrong.csv"));
  CHECK(wrong.exit_code == 5);
  CHECK(has(wrong.err, "no margin"));  // and a warning that few frames are labeled
  CHECK(!std::filesystem::exists(out / "c.json"));
}
