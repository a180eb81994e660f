// Files that older programs wrote, as today's programs take them. README.md says what they are.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "base/npy.h"
#include "support.h"

using namespace vpr;
using test::run_program;
using test::RunOutcome;
namespace fs = std::filesystem;

namespace {

const std::vector<std::string> kFamilies = {"fastable", "fabmap"};

fs::path golden(const std::string& name) { return test::source_path("test/golden") / name; }

/// The recording that the files are of, rendered once.
const fs::path& recording() {
  static const test::TemporaryFolder kFolder;
  static const fs::path kRecording = kFolder / "recording";
  if (!fs::exists(kRecording))
    REQUIRE(run_program("vpr-synth", {golden("world.json"), "-o", kRecording}).exit_code == 0);
  return kRecording;
}

void check_refusal(const RunOutcome& outcome, int exit_code, const std::string& what_to_do) {
  INFO(outcome.err);
  CHECK(outcome.exit_code == exit_code);
  CHECK(outcome.err.find(what_to_do) != std::string::npos);
  CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
}

Json parse(const RunOutcome& outcome) {
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  return Json::parse(outcome.out);
}

// What a query finds, of which nothing says with which database.
Json found_with(const fs::path& database, const std::string& family, const fs::path& out) {
  const std::vector<std::string> threshold = family == "fastable"
                                                 ? std::vector<std::string>{"--c-l", "3"}
                                                 : std::vector<std::string>{"--t-p", "0.3"};
  std::vector<std::string> words = {
      database, "--query", recording() / "back", "-o", out / "r.json", "--force", "--json"};
  words.insert(words.end(), threshold.begin(), threshold.end());
  Json found = parse(run_program("vpr-query", words));
  for (const char* key : {"machine", "timing", "provenance", "checksum"}) found.erase(key);
  found["files"].erase("views");  // from the statistics, which the first layout has not
  return found;
}

std::vector<std::string> truth_of(const std::string& family) {
  if (family == "fastable") return {"--ground-truth", golden("back.ground_truth.csv")};
  return {"--ground-truth", "aligned", "--tolerance", "3"};
}

RunOutcome evaluate(const fs::path& result, const std::string& family,
                    std::vector<std::string> more) {
  std::vector<std::string> words = {result};
  for (const std::string& word : truth_of(family)) words.push_back(word);
  words.insert(words.end(), more.begin(), more.end());
  return run_program("vpr-eval", words);
}

// Results of version 1 hold no margins.
void leave_out_margins(Json& report) {
  report["metrics"].erase("by_margin");
  report["curves"].erase("by_margin");
  report["outcomes"].erase("margins");
  report["protocol"].erase("margin");
}

std::string without_last_column(const std::string& csv) {
  std::string text;
  for (size_t begin = 0; begin < csv.size();) {
    const size_t end = csv.find('\n', begin);
    text += csv.substr(begin, csv.rfind(',', end) - begin) + "\n";
    begin = end + 1;
  }
  return text;
}

}  // namespace

TEST_CASE("databases of the first layout give the results of today's") {
  const test::TemporaryFolder out;
  for (const std::string& family : kFamilies) {
    INFO(family);
    const Json today = found_with(golden("1-views/" + family + ".vprdb"), family, out.path());
    CHECK(today["totals"]["hits"] > 0);
    CHECK(found_with(golden("1-first/" + family + ".vprdb"), family, out.path()) == today);
  }
}

TEST_CASE("databases of the first layout are described and extended") {
  const test::TemporaryFolder out;
  for (const std::string& family : kFamilies) {
    INFO(family);
    const fs::path old = golden("1-first/" + family + ".vprdb");
    CHECK(parse(run_program("vpr-train", {"info", old, "--json"}))["method"] == family);
    const fs::path more = out / (family + ".vprdb");
    const Json added = parse(run_program(
        "vpr-train", {"add", old, "--train", recording() / "back", "-o", more, "--json"}));
    CHECK(parse(run_program("vpr-train", {"info", more, "--json"}))["method"] == family);
  }
}

TEST_CASE("results with a checksum are evaluated as their reports say, whatever else they lack") {
  for (const std::string& family : kFamilies) {
    for (const std::string layout : {"1-sealed", "1-views"}) {
      INFO(layout << " " << family);
      const fs::path result = golden(layout + "/" + family + ".json");
      const fs::path report = golden("1-views/" + family + "-report.json");
      const Json expected = Json::parse(test::read_text(report));
      CHECK(parse(evaluate(result, family, {"--json"}))["counts"] == expected["counts"]);
      CHECK(evaluate(result, family, {"--expect", report}).exit_code == 0);
    }
  }
}

TEST_CASE(
    "a result of version 1 is evaluated as today's of the same query, to the byte, but for "
    "margins") {
  const test::TemporaryFolder out;
  for (const std::string& family : kFamilies) {
    INFO(family);
    const std::vector<std::string> threshold = family == "fastable"
                                                   ? std::vector<std::string>{"--t-r", "0.5"}
                                                   : std::vector<std::string>{"--t-p", "0.3"};
    std::vector<std::string> words = {golden("1-views/" + family + ".vprdb"), "--query",
                                      recording() / "back", "-o", out / (family + ".json")};
    if (family == "fastable") words.insert(words.end(), {"--c-l", "3"});
    words.insert(words.end(), threshold.begin(), threshold.end());
    REQUIRE(run_program("vpr-query", words).exit_code == 0);
    CHECK(Json::parse(test::read_text(out / (family + ".json")))["schema"] == "vpr.result/2");
    const auto report = [&](const fs::path& result, const std::string& name) {
      Json json =
          parse(evaluate(result, family,
                         {"--json", "--name", "same", "--outcomes-csv", out / (name + "-o.csv"),
                          "--recognitions-csv", out / (name + "-r.csv")}));
      for (const char* key : {"machine", "timing", "provenance"}) json.erase(key);
      leave_out_margins(json);
      return json.dump() + without_last_column(test::read_text(out / (name + "-o.csv"))) +
             test::read_text(out / (name + "-r.csv"));
    };
    CHECK(report(golden("1-views/" + family + ".json"), family + "-old") ==
          report(out / (family + ".json"), family + "-new"));
  }
}

TEST_CASE("a result gives a query its settings, whatever it lacks") {
  const test::TemporaryFolder out;
  for (const std::string& family : kFamilies) {
    for (const std::string layout : {"1-sealed", "1-views"}) {
      INFO(layout << " " << family);
      const fs::path result = golden(layout + "/" + family + ".json");
      const Json again = parse(run_program(
          "vpr-query", {golden("1-views/" + family + ".vprdb"), "--query", recording() / "back",
                        "--config", result, "-o", out / "r.json", "--force", "--json"}));
      const Json stored = Json::parse(test::read_text(result));
      for (const auto& setting : stored["settings"].items())
        CHECK(again["settings"][setting.key()] == setting.value());
    }
  }
}

TEST_CASE("results without a checksum are refused with what to do") {
  for (const std::string& family : kFamilies)
    check_refusal(evaluate(golden("1-first/" + family + ".json"), family, {}), 4,
                  "run vpr-query again");
}

TEST_CASE("reports of the first layout are expectations, and refused where queries are paired") {
  for (const std::string& family : kFamilies) {
    INFO(family);
    const fs::path old = golden("1-first/" + family + "-report.json");
    const fs::path today = golden("1-views/" + family + "-report.json");
    CHECK(evaluate(golden("1-views/" + family + ".json"), family, {"--expect", old}).exit_code ==
          0);
    CHECK(run_program("vpr-eval", {"compare", today, today}).exit_code == 0);
    check_refusal(run_program("vpr-eval", {"compare", old, today}), 4, "make it again");
  }
}

TEST_CASE("a sweep, of any layout, is refused as settings with what to do") {
  for (const std::string& family : kFamilies)
    for (const std::string layout : {"1-first", "1-views"})
      check_refusal(run_program("vpr-query", {golden("1-views/" + family + ".vprdb"), "--query",
                                              recording() / "back", "--config",
                                              golden(layout + "/" + family + "-sweep.json")}),
                    2, "--save-config");
}

TEST_CASE("files of a version to come are refused with what to do") {
  const test::TemporaryFolder out;
  const auto newer = [&](const std::string& name) {
    std::string text = test::read_text(golden("1-views/" + name));
    const size_t at = text.find("/1\"");
    text[at + 1] = '9';
    const fs::path path = out / fs::path(name).filename().string();
    test::write_text(path, text);
    return path;
  };
  check_refusal(evaluate(newer("fastable.json"), "fastable", {}), 4, "use a newer version");
  check_refusal(run_program("vpr-eval", {"compare", newer("fastable-report.json"),
                                         golden("1-views/fastable-report.json")}),
                4, "use a newer version");
  newer("fastable.vprdb/manifest.json");
  check_refusal(run_program("vpr-train", {"info", out.path()}), 4, "use a newer version");
}
