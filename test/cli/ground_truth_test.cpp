// vpr-eval convert and check, and every option that accepts a ground truth.
#include <algorithm>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

/// Eight frames against themselves, c_l 2, with a ground truth of pairs.
struct Walk {
  TemporaryFolder folder;
  Walk() {
    fs::create_directory(folder / "one");
    for (int i = 0; i < 8; ++i)
      write_image(folder / "one" / fmt::format("{}.png", i), static_cast<uint64_t>(i) + 1);
    run_ok("vpr-train", {"fastable", "--c-l", "2", "--train", folder / "one", "-o", database()});
    run_ok("vpr-query", {database(), "--query", folder / "one", "--c-l", "2", "--t-r", "0.9", "-o",
                         folder / "r.json"});
    std::string pairs = "query,reference,label\n0,7,same\n5,3,ignore\n";
    for (int i = 0; i < 7; ++i) pairs += fmt::format("{},{},same\n", i, i == 4 ? 5 : i);
    write_text(folder / "g.csv", pairs);
  }
  std::string database() const { return folder / "one.vprdb"; }
  std::string path(const std::string& name) const { return folder / name; }
};

const Walk& walk() {
  static const Walk kShared;
  return kShared;
}

void convert(const std::string& from, const std::string& to, const fs::path& output) {
  run_ok("vpr-eval",
         {"convert", from, "--query-frames", "8", "--train-frames", "8", "--to", to, "-o", output});
}

}  // namespace

TEST_CASE("a result has the same counts with every format of its ground truth") {
  const TemporaryFolder out;
  const auto counts = [&](const std::string& ground_truth) {
    const Json report =
        printed_json("vpr-eval", {walk().path("r.json"), "--ground-truth", ground_truth, "--json"});
    return report["counts"].dump() + report["best_match"].dump();
  };
  const std::string expected = counts(walk().path("g.csv"));
  convert(walk().path("g.csv"), "matrix", out / "g.npz");
  convert(walk().path("g.csv"), "matrix", out / "g.npy");
  for (const std::string name : {"g.npz", "g.npy"}) {
    INFO(name);
    // No recognition is an ignored pair, so that formats without ignored pairs have equal counts.
    CHECK(counts(out / name) == expected);
  }
  convert(out / "g.npz", "pairs", out / "g.npz.csv");
  CHECK(read_text(out / "g.npz.csv") ==
        "query,reference,label\n0,0,same\n0,7,same\n1,1,same\n2,2,same\n3,3,same\n4,5,same\n"
        "5,3,ignore\n5,5,same\n6,6,same\n");
}

TEST_CASE("sequences and results determine the number of frames") {
  const TemporaryFolder out;
  for (const Words& scope :
       {Words{"--query", walk().path("one"), "--train", walk().path("one@0:5")},
        Words{"--query-frames", "8", "--train-frames", "5"}}) {
    const Json report = printed_json("vpr-eval", joined({"check", "aligned", "--json"}, scope));
    CHECK(report["frames"]["query"] == 8);
    CHECK(report["frames"]["train"] == 5);
    CHECK(report["pairs"]["same"] == 5);
    CHECK(report["findings"]["queries_without_match"] == 3);
    CHECK(report["findings"]["one_sided"].is_null());
  }
  const Json report = printed_json(
      "vpr-eval", {"check", walk().path("g.csv"), "--result", walk().path("r.json"), "--json"});
  CHECK(report["pairs"]["same"] == 8);
  CHECK(report["pairs"]["ignored"] == 1);
  CHECK(report["findings"]["one_sided"]["count"] == 2);
  CHECK(report["findings"]["one_sided"]["examples"][0] ==
        "query 0 and reference 7 are the same place, but query 7 and reference 0 are not");
}

TEST_CASE("a check of a damaged ground truth reports the damage and exits with 4") {
  const TemporaryFolder out;
  write_text(out / "g.csv", "query,reference,label\n0,0,\n0,0,ignore\n9,0,\n");
  const auto outcome =
      run_program("vpr-eval", {"check", out / "g.csv", "--query-frames", "3", "--train-frames", "3",
                               "--json", "-o", out / "c.json"});
  check_failure(outcome, 4, "damaged");
  const Json report = Json::parse(outcome.out);
  CHECK(report["findings"]["out_of_range"]["count"] == 1);
  CHECK(report["findings"]["contradiction"]["count"] == 1);
  CHECK(fs::exists(out / "c.json"));
  const auto table = run_program(
      "vpr-eval", {"check", out / "g.csv", "--query-frames", "3", "--train-frames", "3"});
  CHECK(table.exit_code == 4);
  CHECK(has(table.out, "line 4: query 9 is out of range"));
  check_failure("vpr-eval",
                {"convert", out / "g.csv", "--query-frames", "3", "--train-frames", "3", "--to",
                 "matrix", "-o", out / "m.npz"},
                4, "damaged");
  CHECK_FALSE(fs::exists(out / "m.npz"));
  write_text(out / "cut.npy", "\x93NUMPY");
  check_failure("vpr-eval", {"check", out / "cut.npy"}, 4, "cut.npy");
}

TEST_CASE("invalid arguments of convert and check are refused") {
  const TemporaryFolder out;
  const std::string pairs = walk().path("g.csv");
  const auto convert_to = [&](const std::string& to, Words more = {}) {
    return run_program("vpr-eval", joined({"convert", pairs, "--to", to, "-o", out / "x"}, more));
  };
  check_failure(convert_to("aligned"), 2, "Use --to with pairs, matrix");
  check_failure(convert_to("matrices"), 2, "did you mean matrix");
  check_failure(convert_to("matrix", {"--query-frames", "8"}), 2, "go together");
  check_failure(convert_to("matrix", {"--query", walk().path("one")}), 2, "go together");
  check_failure(convert_to("matrix", {"--query-frames", "8", "--result", walk().path("r.json")}), 2,
                "Use one");
  check_failure(convert_to("matrix", {"--from", "tum"}), 2, "--ground-truth-train");
  check_failure(convert_to("matrix", {"--radius", "3"}), 2, "--radius has no effect");
  check_failure(convert_to("matrix", {"--matrix-rows", "rows"}), 2, "matrix-rows");
  check_failure("vpr-eval", {"convert", pairs, "--to", "matrix"}, 2, "-o");
  check_failure("vpr-eval", {"convert", out / "no", "--to", "matrix", "-o", out / "x"}, 3, "no");
  check_failure("vpr-eval", {"check", "aligned"}, 2, "frames");
  check_failure("vpr-eval", {}, 2, "result");
  CHECK(list_folder(out.path()).empty());
  // A loss of information is reported.
  const auto lossy = ok(convert_to("matrix"));
  CHECK(has(lossy.err, "1 pair labeled ignore"));
}

TEST_CASE("one command counts a result under every protocol") {
  const Json all =
      printed_json("vpr-eval", {walk().path("r.json"), "--protocol", "nordland-all", "--json"});
  REQUIRE(all["protocols"].size() == 4);
  for (const Json& protocol : all["protocols"]) {
    const std::string name = protocol["name"].get<std::string>();
    const Json report =
        printed_json("vpr-eval", {walk().path("r.json"), "--ground-truth", name, "--json"});
    CHECK(report["counts"] == protocol["report"]["counts"]);
    CHECK(report["protocol"]["ground_truth"].get<std::string>().starts_with(name));
  }
  const auto table = run_program("vpr-eval", {walk().path("r.json"), "--protocol",
                                              "nordland-25m,nordland-exact", "--format", "csv"});
  CHECK(table.out.starts_with("protocol,"));
  CHECK(table.out.find("\nnordland-25m,") < table.out.find("\nnordland-exact,"));
  check_failure("vpr-eval", {walk().path("r.json"), "--protocol", "nordland"}, 2, "nordland-all");
  check_failure("vpr-eval",
                {walk().path("r.json"), "--protocol", "nordland-all", "--ground-truth", "aligned"},
                2, "--protocol");
}

TEST_CASE("vpr-eval and vpr-tune accept every format, and data sets name it") {
  const TemporaryFolder out;
  convert(walk().path("g.csv"), "matrix", out / "g.npz");
  const auto tune = [&](Words more) {
    Words words =
        joined({"fastable", walk().database(), "--c-l", "2", "--t-r", "0.9", "--json"}, more);
    return printed_json("vpr-tune", words)["cells"].dump();
  };
  const std::string expected =
      tune({"--query", walk().path("one"), "--ground-truth", walk().path("g.csv")});
  CHECK(tune({"--query", walk().path("one"), "--ground-truth", out / "g.npz"}) == expected);
  write_text(out / "d.json", fmt::format(R"({{"schema": "vpr.dataset/3", "name": "d", "queries": [
      {{"name": "one", "sequence": "{}", "ground_truth": {{"path": "g.npz",
        "matrix_rows": "reference"}}}}]}})",
                                         walk().path("one")));
  CHECK(tune({"--dataset", out / "d.json"}) == expected);
  CHECK(printed_json("vpr-eval",
                     {walk().path("r.json"), "--dataset", out / "d.json", "--json"})["counts"] ==
        printed_json("vpr-eval", {walk().path("r.json"), "--ground-truth", walk().path("g.csv"),
                                  "--json"})["counts"]);
}

TEST_CASE("several results form one table, with a row and a name for each") {
  const TemporaryFolder out;
  run_ok("vpr-query", {walk().database(), "--query", walk().path("one"), "--c-l", "3", "--t-r",
                       "0.9", "-o", out / "long.json", "--quiet"});
  Words words = {walk().path("r.json"), out / "long.json", "--ground-truth", walk().path("g.csv")};
  const auto table =
      run_ok("vpr-eval",
             joined(words, {"--format", "csv", "--name", "c_l 2", "--name", "c_l 3",
                            "--outcomes-csv", out / "o.csv", "--recognitions-csv", out / "p.csv"}));
  CHECK(table.out.starts_with("name,method,query,c_l,"));
  CHECK(std::count(table.out.begin(), table.out.end(), '\n') == 3);
  CHECK(has(table.out, "\nc_l 3,fastable,one,3,"));
  const std::string outcomes = read_text(out / "o.csv");
  CHECK(std::count(outcomes.begin(), outcomes.end(), '\n') == 1 + 8 + 8);
  CHECK(has(outcomes, "\nc_l 2,one,0,1,one,1,"));
  CHECK(read_text(out / "p.csv").starts_with("name,query,sequence,first_frame,frame,"));
  const Json reports =
      printed_json("vpr-eval", joined(words, {"--json", "-o", out / "reports.json"}));
  CHECK(reports["schema"] == "vpr.reports/4");
  CHECK(reports["reports"][1]["name"] == "long");
  CHECK(reports["reports"][1]["report"]["settings"]["c_l"] == 3);
  check_failure("vpr-eval", joined(words, {"--name", "one only"}), 2, "2 results and 1 names");
  check_failure("vpr-eval", joined(words, {"--html", out / "x.html"}), 2, "one result");
  const std::string text = run_program("vpr-eval", joined(words, {"-v"})).out;
  CHECK(has(text, "By keyframe"));
}

TEST_CASE("poses by time and anchors are accepted as flags and in data sets") {
  const TemporaryFolder folder;
  std::string poses;
  for (int i = 0; i <= 10; ++i) poses += fmt::format("{:.1f} {} 0 0 0 0 0 1\n", 100 + i * 0.1, i);
  write_text(folder / "p.tum", poses);
  write_text(folder / "t.txt", "0\n0.25\n0.5\n");
  write_text(folder / "late.txt", "50\n51\n");
  const std::string path = folder / "p.tum";
  const auto check = [&](const std::string& times, const std::string& offset) {
    return run_program(
        "vpr-eval", {"check", path, "--ground-truth-train", path, "--radius", "1", "--query-times",
                     folder / times, "--offset", offset, "--max-difference", "0.06", "--json"});
  };
  const Json found = printed_json(check("t.txt", "100"));
  CHECK(found["frames"]["query"] == 3);
  CHECK(found["pairs"]["same"] == 2 + 2 + 3);  // at 0, 2.5 and 5 meters
  CHECK(found["protocol"] ==
        "tum poses at the times of query frames, the nearest within 0.06 s, query times +100 s: "
        "within 1 m");
  check_failure(check("late.txt", "0"), 4,
                "they cover 50 to 51 s, but " + path + " covers 100 to 101 s");
  // Flags that a format does not use are refused.
  write_text(folder / "walk.anchors.csv", "query,anchor\n0,0\n4,8\n");
  const std::string anchors = folder / "walk.anchors.csv";
  CHECK(run_program("vpr-eval", {"check", anchors, "--offset", "3"}).exit_code == 2);
  CHECK(printed_json("vpr-eval", {"check", anchors, "--tolerance", "1",
                                  "--json"})["pairs"]["same"] == 2 + 3 * 3 + 2);
}
