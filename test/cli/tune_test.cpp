// vpr-tune on a small world.
#include <algorithm>
#include <map>

#include <catch2/catch.hpp>

#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

const std::string kFastable = "vpr-tune fastable $db --query $back --ground-truth $truth ";
const std::string kGrid = kFastable + "--c-l 2,10:20:10 --t-r 0.3:0.5:0.1,auto ";
const std::string kTrial = "vpr-tune $db --query $back --ground-truth $truth ";

// Frames that are not where the query was.
void write_wrong_truth() {
  write_text("wrong.csv", "query,sequence,reference\n20,one,0\n21,one,0\n22,two,0\n");
}

Json query_with(const std::string& config) {
  run_ok("vpr-query $db --query $back --config " + config + " --force -o r.json");
  return printed_json("vpr-eval r.json --ground-truth $truth --json");
}

// A data set of queries with their ground truths.
void write_dataset(const std::string& path, const std::map<std::string, std::string>& truths) {
  Json queries;
  for (const auto& [name, truth] : truths)
    queries.push_back({{"name", name},
                       {"sequence", world().walk(name)},
                       {"ground_truth", {{"format", "pairs"}, {"path", truth}}}});
  write_text(path, Json{{"schema", "vpr.dataset/3"}, {"name", path}, {"queries", queries}}.dump());
}

// The words of the command at the end of a text, without the quotes of a shell.
std::string command_of(const std::string& text) {
  std::string joined = text.substr(text.find("vpr-query "));
  for (size_t at = 0; (at = joined.find(" \\\n")) != std::string::npos;) joined.erase(at, 2);
  std::replace(joined.begin(), joined.begin() + ptrdiff_t(joined.find("result.json")), '\n', ' ');
  return lines_of(joined).front();
}

}  // namespace

TEST_CASE("the choice has the frames of vpr-query and vpr-eval with the printed command") {
  const auto outcome = run_ok(kTrial + "-v -o t.json");
  const Json tuning = file_json("t.json");
  REQUIRE(tuning["trials"].size() == 3);
  CHECK(tuning["trials"][0]["settings"]["method"] == "filter");
  CHECK(tuning["trials"][1]["settings"]["score"] == "zscore");
  CHECK(tuning["trials"][2]["settings"]["t_r"].is_number());
  for (const Json& one : tuning["trials"]) {
    const std::string name = one["name"];
    INFO(name);
    const size_t at = outcome.out.find("\n" + name + ":\n");
    REQUIRE(at != std::string::npos);
    const std::string command = command_of(outcome.out.substr(at));
    REQUIRE(command.ends_with(" result.json"));
    run_ok(command + " --force");
    const Json report = printed_json("vpr-eval result.json --ground-truth $truth --json");
    CHECK(report["settings"] == one["settings"]);
    CHECK(report["localization"]["correct"] == one["correct"]);
    CHECK(report["localization"]["incorrect"] == one["incorrect"]);
  }
  const Json& chosen = tuning["trials"][tuning["chosen"].get<size_t>()];
  CHECK(chosen["incorrect"] == 0);
  for (const Json& one : tuning["trials"])
    if (one["incorrect"] == 0) CHECK(one["correct"] <= chosen["correct"]);
  CHECK(tuning["settings"] == chosen["settings"]);
  check_screen(run_ok(kTrial).out);
  CHECK(printed_json(kTrial + "--max-incorrect 7 --json")["max_incorrect"] == 7);
}

TEST_CASE("the choice is a configuration") {
  run_ok(kTrial + "-o t.json --save-config c.json");
  const Json settings = file_json("t.json")["settings"];
  Json config = file_json("c.json");
  config.erase("schema");
  CHECK(config == settings);
  for (const std::string file : {"c.json", "t.json"})
    CHECK(query_with(file)["settings"] == settings);
}

TEST_CASE("without a correct frame there is no choice, no command and no configuration") {
  write_wrong_truth();
  const auto outcome =
      run("vpr-tune $db --query $back --ground-truth wrong.csv --save-config c.json");
  CHECK(outcome.exit_code == 5);
  CHECK(has(outcome.out, "no setting recognizes a frame correctly"));
  CHECK(has(outcome.out, "Check the ground truth."));
  CHECK_FALSE(has(outcome.out, "vpr-query"));
  CHECK(!fs::exists("c.json"));
}

TEST_CASE("FAB-MAP is tried with its database") {
  run_ok("vpr-train fastable --train $one -o one.vprdb");
  const Json tuning = printed_json(
      "vpr-tune one.vprdb --query $back --ground-truth aligned --tolerance 25 --fabmap $fabmap "
      "--json");
  REQUIRE(tuning["trials"].size() == 4);
  CHECK(tuning["trials"][3]["settings"]["method"] == "fabmap");
  CHECK(tuning["trials"][3]["frames"] == tuning["trials"][0]["frames"]);
}

TEST_CASE("a sweep fits a terminal, and commands repeat the selection of frames") {
  check_screen(run_ok(kGrid + "--speed 2").out, 12 + 5);
  CHECK(has(run_ok(kTrial + "--speed 2").out, "--speed 2"));
}

TEST_CASE("the recommended setting is reported for another sequence") {
  const auto outcome = run_ok(kGrid +
                              "--validate $again --validate-ground-truth $again.ground_truth.csv "
                              "--heat-map h.png -o s.json");
  CHECK(has(outcome.out, "Recommended: c_l"));
  CHECK_FALSE(has(outcome.err, "not seen"));
  const Json query = file_json("s.json")["queries"][0];
  CHECK(query["validation"]["query"] == "again");
  CHECK(query["intervals"]["correct_recognitions"][0] <=
        query["intervals"]["correct_recognitions"][1]);
  CHECK(read_text("h.png").substr(1, 3) == "PNG");
  CHECK(has(run_ok(kGrid + "--validate $back --validate-ground-truth $truth --json").err,
            "not seen"));
}

TEST_CASE("automatic thresholds are listed with their frames, and stored with --write") {
  fs::copy(world().database(), "w.vprdb");
  const Json thresholds =
      printed_json("vpr-tune threshold w.vprdb --c-l 5,10 --write --json")["thresholds"];
  REQUIRE(thresholds.size() == 4);
  const Json info = printed_json("vpr-train info w.vprdb --json");
  for (const Json& t_r : info["sequences"][0]["t_r"])
    for (const Json& item : thresholds)
      if (item["sequence"] == info["sequences"][0]["name"] && item["c_l"] == t_r["c_l"])
        CHECK(item["t_r"] == t_r["bits"]);
  CHECK(info["sequences"][0]["t_r"].size() == 2);
}

TEST_CASE("lists and ranges of vpr-tune name every value once") {
  const auto cells = [](const std::string& grid) {
    return printed_json(kFastable + "--json --c-l " + grid)["cells"];
  };
  CHECK(cells("5 --t-r auto").size() == 1);
  CHECK(cells("5 --t-r auto,0.3").size() == 2);
  CHECK(cells("5 --t-r 0.3,auto,0.4,auto").size() == 3);
  CHECK(cells("5,5,4:5 --t-r 0.2:0.4:0.1,0.3").size() == 2 * 3);
  CHECK(cells("5 --t-r 0.1:0.9:0.2")[4]["t_r"] == 0.9);
}

TEST_CASE("a batch of data sets is written completely or not at all, next to other files") {
  for (const std::string name : {"back", "again"})
    write_dataset(name + ".json", {{name, name + ".csv"}});
  const std::string tune =
      "vpr-tune fastable $db --dataset back.json --dataset again.json --c-l 5,10 --t-r 0.3,0.4 "
      "-o s.json";
  fs::copy(world().truth("back"), "back.csv");
  write_text("again.csv", "broken");
  write_text("s.json.partial", "the user's own");
  CHECK(run(tune).exit_code == 4);
  CHECK(!fs::exists("s.json"));
  fs::copy(world().truth("again"), "again.csv", fs::copy_options::overwrite_existing);
  run_ok(tune);
  CHECK(read_text("s.json.partial") == "the user's own");
  const Json sweep = file_json("s.json");
  REQUIRE(sweep["queries"].size() == 2);
  CHECK(sweep["queries"][1]["name"] == "again");
  CHECK(sweep["cells"].size() == 2 * 2 * 2);
}

TEST_CASE("vpr-query with a recommended margin has its recognitions") {
  for (const std::string score : {"raw", "zscore"}) {
    const Json sweep = printed_json(kFastable + "--decide margin --score " + score +
                                    " --save-config c.json --force --json");
    const Json cell = sweep["cells"][sweep["queries"][0]["recommended"].get<size_t>()];
    CHECK(cell["counts"]["pairs"]["incorrect"] == 0);
    CHECK(cell["unknown_place"] == 0);
    CHECK(query_with("c.json")["counts"] == cell["counts"]);
  }
}

TEST_CASE("vpr-tune chooses without a grid or an output, and vpr-query accepts its choice") {
  const auto plain = run_ok(kFastable);
  CHECK_FALSE(has(plain.out, "accepted pairs by t_r and c_l"));
  CHECK(plain.out.starts_with("back: best t_r of each c_l, over "));
  check_screen(plain.out, 12 + 5);  // 5 window lengths
  CHECK(has(run_ok(kFastable + "-v").out, "accepted pairs by t_r and c_l (* recommended)"));
  CHECK(has(plain.out, "vpr-query " + world().database()));
  const auto saved = run_ok(kFastable + "--save-config c.json -o s.json");
  CHECK(has(saved.out, "--config c.json"));
  const Json sweep = file_json("s.json");
  Json settings = sweep["queries"][0]["recommended_settings"];
  Json config = file_json("c.json");
  CHECK(config["schema"] == "vpr.config/3");
  config.erase("schema");
  CHECK(config == settings);
  const Json cell = sweep["cells"][sweep["queries"][0]["recommended"].get<size_t>()];
  CHECK(settings["c_l"] == cell["c_l"]);
  CHECK(cell["counts"]["pairs"]["incorrect"] == 0);
  // The counts of the recommended cell, from the file alone.
  run_ok("vpr-query $db --query $back --config c.json -o r.json");
  const Json report = printed_json("vpr-eval r.json --ground-truth $truth --json");
  CHECK(report["counts"] == cell["counts"]);
  CHECK(report["settings"] == settings);
}

TEST_CASE("without a recommendation there is no configuration, and the exit code reports it") {
  const auto outcome = run(kFastable + "--c-l 5 --t-r 0.01,0.02 --save-config c.json -o s.json");
  CHECK(outcome.exit_code == 5);
  CHECK(has(outcome.err, "no setting recognizes a frame"));
  CHECK(has(outcome.out, "The filter recognizes "));
  CHECK(list_folder(".") == Words{"s.json"});
  const Json query = file_json("s.json")["queries"][0];
  CHECK(query["advice"] == "no_recognitions");
  CHECK((query["recommended"].is_null() && query["recommended_settings"].is_null()));
}

TEST_CASE("FAB-MAP has a default grid as well") {
  const auto outcome = run_ok(
      "vpr-tune fabmap $fabmap --query $back --ground-truth aligned --tolerance 25 --format csv -o "
      "s.json");
  const Json sweep = file_json("s.json");
  CHECK(sweep["cells"].size() == 5 * 10);
  CHECK(std::count(outcome.out.begin(), outcome.out.end(), '\n') == 1 + 5 * 10);
  CHECK(outcome.out.starts_with("query,c_w,t_p,scale,pairs_correct,pairs_incorrect"));
}

TEST_CASE("the validation may be another query of the data set, selected by name") {
  write_dataset("d.json", {{"back", world().truth("back")}, {"again", world().truth("again")}});
  const std::string tune = "vpr-tune fastable $db --dataset d.json --query back ";
  const auto outcome = run_ok(tune + "--validate again");
  CHECK(has(outcome.out, "On the validation, again: "));
  CHECK_FALSE(has(outcome.out, "{"));
  CHECK(run(tune + "--validate none").exit_code == 2);
  CHECK(run(tune + "--validate-ground-truth $again.ground_truth.csv").exit_code == 2);
}
