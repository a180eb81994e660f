// vpr-eval convert and check, and every option that accepts a ground truth.
#include <algorithm>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

// Eight frames against themselves, c_l 2, with a ground truth of pairs.
void make_walk() {
  write_walk("one", 8, 1);
  run_ok("vpr-train fastable --c-l 2 --train one -o one.vprdb");
  run_ok("vpr-query one.vprdb --query one --c-l 2 --t-r 0.9 -o r.json");
  std::string pairs = "query,reference,label\n0,7,same\n5,3,ignore\n";
  for (int i = 0; i < 7; ++i) pairs += fmt::format("{},{},same\n", i, i == 4 ? 5 : i);
  write_text("g.csv", pairs);
}

RunOutcome convert(const std::string& from, const std::string& to, const std::string& output) {
  return run_ok("vpr-eval convert " + from + " --query-frames 8 --train-frames 8 --to " + to +
                " -o " + output);
}

}  // namespace

TEST_CASE("a result has the same counts with every format of its ground truth") {
  start_with(make_walk);
  const auto counts = [&](const std::string& ground_truth) {
    const Json report = printed_json("vpr-eval r.json --ground-truth " + ground_truth + " --json");
    return report["counts"].dump() + report["best_match"].dump();
  };
  const std::string expected = counts("g.csv");
  convert("g.csv", "matrix", "g.npz");
  CHECK(has(convert("g.csv", "matrix", "g.npy").err, "1 pair labeled ignore"));
  for (const std::string name : {"g.npz", "g.npy"}) {
    INFO(name);
    // No recognition is an ignored pair, so that formats without ignored pairs have equal counts.
    CHECK(counts(name) == expected);
  }
  convert("g.npz", "pairs", "g.npz.csv");
  CHECK(read_text("g.npz.csv") ==
        "query,reference,label\n0,0,same\n0,7,same\n1,1,same\n2,2,same\n3,3,same\n4,5,same\n5,3,"
        "ignore\n5,5,same\n6,6,same\n");
}

TEST_CASE("sequences and results determine the number of frames") {
  start_with(make_walk);
  for (const std::string scope :
       {"--query one --train one@0:5", "--query-frames 8 --train-frames 5"}) {
    const Json report = printed_json("vpr-eval check aligned --json " + scope);
    CHECK(report["frames"]["query"] == 8);
    CHECK(report["frames"]["train"] == 5);
    CHECK(report["pairs"]["same"] == 5);
    CHECK(report["findings"]["queries_without_match"] == 3);
    CHECK(report["findings"]["one_sided"].is_null());
  }
  const Json report = printed_json("vpr-eval check g.csv --result r.json --json");
  CHECK(report["pairs"]["same"] == 8);
  CHECK(report["pairs"]["ignored"] == 1);
  CHECK(report["findings"]["one_sided"]["count"] == 2);
  CHECK(report["findings"]["one_sided"]["examples"][0] ==
        "query 0 and reference 7 are the same place, but query 7 and reference 0 are not");
}

TEST_CASE("a check of a damaged ground truth reports the damage and exits with 4") {
  write_text("g.csv", "query,reference,label\n0,0,\n0,0,ignore\n9,0,\n");
  const auto outcome =
      run("vpr-eval check g.csv --query-frames 3 --train-frames 3 --json -o c.json");
  check_failure(outcome, 4, "damaged");
  const Json report = Json::parse(outcome.out);
  CHECK(report["findings"]["out_of_range"]["count"] == 1);
  CHECK(report["findings"]["contradiction"]["count"] == 1);
  CHECK(fs::exists("c.json"));
  const auto table = run("vpr-eval check g.csv --query-frames 3 --train-frames 3");
  CHECK(table.exit_code == 4);
  CHECK(has(table.out, "line 4: query 9 is out of range"));
}

TEST_CASE("vpr-eval and vpr-tune accept every format, and data sets name it") {
  start_with(make_walk);
  convert("g.csv", "matrix", "g.npz");
  const auto tune = [&](const std::string& more) {
    return printed_json("vpr-tune fastable one.vprdb --c-l 2 --t-r 0.9 --json " + more)["cells"];
  };
  const Json expected = tune("--query one --ground-truth g.csv");
  CHECK(tune("--query one --ground-truth g.npz") == expected);
  write_text("d.json", R"({"schema": "vpr.dataset/3", "name": "d", "queries": [
      {"name": "one", "sequence": "one", "ground_truth": {"path": "g.npz",
        "matrix_rows": "reference"}}]})");
  CHECK(tune("--dataset d.json") == expected);
  CHECK(printed_json("vpr-eval r.json --dataset d.json --json")["counts"] ==
        printed_json("vpr-eval r.json --ground-truth g.csv --json")["counts"]);
}

TEST_CASE("several results form one table, with a row and a name for each") {
  start_with(make_walk);
  run_ok("vpr-query one.vprdb --query one --c-l 3 --t-r 0.9 -o long.json --quiet");
  const std::string words = "r.json long.json --ground-truth g.csv";
  const auto table = run_ok(
      "vpr-eval " + words +
      " --format csv --name 'c_l 2' --name 'c_l 3' --outcomes-csv o.csv --recognitions-csv p.csv");
  CHECK(table.out.starts_with("method,query,c_l,t_r,scale,R@1,"));
  CHECK(has(table.out, ",pairs by place correct,"));
  CHECK(std::count(table.out.begin(), table.out.end(), '\n') == 3);
  CHECK(has(table.out, "\nc_l 3,one,3,"));
  const std::string outcomes = read_text("o.csv");
  CHECK(std::count(outcomes.begin(), outcomes.end(), '\n') == 1 + 8 + 8);
  CHECK(has(outcomes, "\nc_l 2,one,0,1,one,1,"));
  CHECK(read_text("p.csv").starts_with("name,query,sequence,first_frame,frame,"));
  const Json reports = printed_json("vpr-eval " + words + " --json -o reports.json");
  CHECK(reports["schema"] == "vpr.reports/5");
  CHECK(reports["reports"][1]["name"] == "long");
  CHECK(reports["reports"][1]["report"]["settings"]["c_l"] == 3);
  const std::string brief = run("vpr-eval " + words).out;
  const std::string text = run("vpr-eval " + words + " -v").out;
  CHECK(text.starts_with(brief));
  CHECK(has(text.substr(brief.size()), "  longest gap  "));
}

TEST_CASE("query times with an offset find poses by time") {
  std::string poses;
  for (int i = 0; i <= 10; ++i) poses += fmt::format("{:.1f} {} 0 0 0 0 0 1\n", 100 + i * 0.1, i);
  write_text("p.tum", poses);
  write_text("t.txt", "0\n0.25\n0.5\n");
  const Json found = printed_json(
      "vpr-eval check p.tum --ground-truth-train p.tum --radius 1 --query-times t.txt --offset 100 "
      "--max-difference 0.06 --json");
  CHECK(found["pairs"]["same"] == 2 + 2 + 3);  // at 0, 2.5 and 5 meters
}
