// vpr-eval on scores of other programs, as a user runs it.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/json.h"
#include "base/npy.h"
#include "support.h"

using namespace vpr;
using test::run_program;

namespace {

/// Twelve queries against twelve references, aligned: queries 0 to 8 are right with distances 1 to
/// 9, queries 9 to 11 prefer the reference 0 with distances 4.5, 10 and 11.
std::string write_scores(const test::TemporaryFolder& folder, const std::string& name = "s.npy",
                         double sign = 1) {
  std::vector<float> scores(144, float(20 * sign));
  for (size_t q = 0; q < 9; ++q) scores[13 * q] = float(sign * double(q + 1));
  scores[9 * 12] = float(4.5 * sign);
  scores[10 * 12] = float(10 * sign);
  scores[11 * 12] = float(11 * sign);
  Output file(folder / name, Existing::replace);
  write_npy<float>(file, scores, {12, 12});
  file.commit();
  return folder / name;
}

Json report_of(std::vector<std::string> words) {
  words.emplace_back("--json");
  const auto run = run_program("vpr-eval", words);
  REQUIRE(run.err.empty());
  REQUIRE(run.exit_code == 0);
  return Json::parse(run.out);
}

}  // namespace

TEST_CASE("scores of any program are evaluated by the field's metrics") {
  const test::TemporaryFolder folder;
  const Json report =
      report_of({"--scores", write_scores(folder), "--distance", "--ground-truth", "aligned"});
  CHECK(report["method"] == "s");
  CHECK(report["best_match"]["queries"] == 12);
  CHECK(report["best_match"]["correct"] == 9);
  const Json& single = report["metrics"]["single_best"];
  CHECK(single["to_find"] == 12);
  // Four right ones, the wrong one at 4.5, five more right ones.
  const double expected = (4 + 5 / 6.0 + 6 / 7.0 + 7 / 8.0 + 8 / 9.0 + 9 / 10.0) / 12;
  CHECK(single["average_precision"].get<double>() == Approx(expected));
  CHECK(single["recall_at_100_precision"].get<double>() == Approx(4 / 12.0));
  CHECK(single["thresholds"]["recall_at_100_precision"] == 4);
  CHECK(report["metrics"]["recall_at"]["1"] == 0.75);
  // Behind the one that is closer all others tie; the first comes first.
  CHECK(report["metrics"]["recall_at"]["5"] == 0.75);
  CHECK(report["metrics"]["recall_at"]["10"].get<double>() == Approx(10 / 12.0));
  CHECK(report["metrics"]["recall_at"]["20"] == 1);
  CHECK(report["localisation"]["right"] == 4);
  CHECK(report["localisation"]["longest_gap_frames"] == 8);
  CHECK(report["outcomes"]["best"] == "cccccccccwww");
}

TEST_CASE("similarities, and a threshold of one's own") {
  const test::TemporaryFolder folder;
  const std::string turned = write_scores(folder, "t.npy", -1);
  const Json report = report_of({"--scores", turned, "--similarity", "--ground-truth", "aligned",
                                 "--threshold", "-5", "--name", "mine"});
  CHECK(report["method"] == "mine");
  CHECK(report["metrics"]["single_best"]["max_f1"] ==
        report_of({"--scores", write_scores(folder), "--distance", "--ground-truth",
                   "aligned"})["metrics"]["single_best"]["max_f1"]);
  CHECK(report["localisation"]["right"] == 5);
  CHECK(report["localisation"]["wrong"] == 1);
  CHECK_FALSE(report.contains("oracle"));
  const auto text = run_program("vpr-eval", {"--scores", turned, "--similarity", "--ground-truth",
                                             "aligned", "--threshold", "-5"});
  CHECK(text.out.rfind("Best match right in 9 of 12 frames (75.0 %). Recognised in 6 of 12 frames, "
                       "1 of them wrong; the first right one at frame 0.\n",
                       0) == 0);
}

TEST_CASE("an operating point from the ground truth is not compared as one that was chosen") {
  const test::TemporaryFolder folder;
  const std::string scores = write_scores(folder);
  const auto report = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"--scores", scores, "--distance",
                                      "--name",   name,   "--ground-truth",
                                      "aligned",  "-o",   folder / (name + ".json"),
                                      "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    REQUIRE(run_program("vpr-eval", words).exit_code == 0);
    return std::string(folder / (name + ".json"));
  };
  // The fixed threshold has 7 of 12 right and the one at 4.5 wrong; the oracle's best is 4 of 12.
  const std::string fixed = report("fixed", {"--threshold", "7"});
  const std::string oracle = report("oracle", {});
  const std::string late = report("late", {"--threshold", "2"});
  const auto text = run_program("vpr-eval", {"compare", oracle, late, fixed}).out;
  CHECK(text.find("threshold from the ground truth") != std::string::npos);
  CHECK(text.find("0.5833*") != std::string::npos);
  const std::string csv =
      run_program("vpr-eval", {"compare", oracle, late, fixed, "--format", "csv"}).out;
  CHECK(csv.find("queries,fixed,,same,wrong,1,") != std::string::npos);
  // Beside a chosen threshold with less the oracle is not the best; beside another it may be.
  const auto less = run_program("vpr-eval", {"compare", oracle, late, "--format", "markdown"}).out;
  CHECK(less.find("| 0.3333 | 0 | 8 |") != std::string::npos);
  const auto both = run_program("vpr-eval", {"compare", oracle, oracle, "--format", "markdown"});
  CHECK(both.out.find("| **0.3333** | 0 | **8** |") != std::string::npos);
}

TEST_CASE("the headline of lists without a confidence is how many are right") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "pairs.txt", "0 0\n1 1\n2 5\n3 3\n");
  const auto run =
      run_program("vpr-eval", {"--predictions", folder / "pairs.txt", "--ground-truth", "aligned"});
  INFO(run.err);
  CHECK(run.out.rfind("Best match right in 3 of 4 frames (75.0 %).\n", 0) == 0);
}

TEST_CASE("positions give gaps in metres") {
  const test::TemporaryFolder folder;
  std::string poses = "frame,x,y\n";
  for (int i = 0; i < 12; ++i) poses += std::to_string(i) + "," + std::to_string(2 * i) + ",0\n";
  test::write_text(folder / "p.csv", poses);
  const Json report = report_of({"--scores", write_scores(folder), "--distance", "--ground-truth",
                                 "aligned", "--poses", folder / "p.csv"});
  CHECK(report["localisation"]["longest_gap_m"] == 16);
  CHECK(report["localisation"]["first_fix_m"] == 0);
}

TEST_CASE("metrics can be expected") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "x.json", R"({"schema": "vpr.expected/1", "metrics":
      {"recall_at": {"1": {"value": 0.8, "tolerance": 0.01}}}})");
  const auto run =
      run_program("vpr-eval", {"--scores", write_scores(folder), "--distance", "--ground-truth",
                               "aligned", "--expect", folder / "x.json"});
  CHECK(run.exit_code == 5);
  CHECK(run.err.find("metrics.recall_at.1: expected 0.8 +- 0.01, found 0.75") != std::string::npos);
  test::write_text(folder / "y.json", R"({"schema": "vpr.expected/1", "counts": {"distinct": 3}})");
  CHECK(run_program("vpr-eval", {"--scores", write_scores(folder), "--distance", "--ground-truth",
                                 "aligned", "--expect", folder / "y.json"})
            .exit_code == 2);
}

TEST_CASE("scores that can't be evaluated end with their exit code and one sentence") {
  const test::TemporaryFolder folder;
  const std::string scores = write_scores(folder);
  test::write_text(folder / "text.npy", "no array");
  const auto code = [](std::vector<std::string> words) {
    words.insert(words.end(), {"--ground-truth", "aligned"});
    const auto run = run_program("vpr-eval", words);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    return run.exit_code;
  };
  CHECK(code({}) == 2);
  CHECK(code({"--scores", scores}) == 2);
  CHECK(code({"--scores", scores, "--distance", "--similarity"}) == 2);
  CHECK(code({"--scores", scores, "--distance", "--rows-are-windows-of", "0"}) == 2);
  CHECK(code({"--scores", scores, "--distance", "--rows-are-windows-of", "18446744073709551615"}) ==
        2);
  CHECK(run_program("vpr-eval", {"r.json", "--protocol", "nordland-exact", "--html", "x.html"})
            .exit_code == 2);
  CHECK(code({"r.json", "--distance"}) == 2);
  CHECK(code({"r.json", "--scores", scores, "--rows-are-windows-of", "3"}) == 2);
  CHECK(code({"--scores", folder / "none.npy", "--distance"}) == 3);
  CHECK(code({"--scores", folder / "text.npy", "--distance"}) == 4);
  CHECK(code({"--scores", scores, "--distance", "--poses", folder / "text.npy"}) == 4);
}

TEST_CASE("CSV has everything in one row, text a table each") {
  const test::TemporaryFolder folder;
  const std::vector<std::string> words = {"--scores", write_scores(folder), "--distance",
                                          "--ground-truth", "aligned"};
  auto csv = words;
  csv.insert(csv.end(), {"--format", "csv"});
  const std::string row = run_program("vpr-eval", csv).out;
  CHECK(std::count(row.begin(), row.end(), '\n') == 2);
  CHECK(row.find("best AP,") != std::string::npos);
  CHECK(row.find("pairs AP,") != std::string::npos);
  CHECK(row.find("R@10,") != std::string::npos);
  const std::string text = run_program("vpr-eval", words).out;
  CHECK(text.find("Recall@K") != std::string::npos);
  CHECK(text.find("12 queries with a match; 0 without one") != std::string::npos);
}

TEST_CASE("pictures: a page with the frames of both sequences, and plots") {
  const test::TemporaryFolder folder;
  for (const std::string name : {"q", "r"}) {
    std::filesystem::create_directory(folder / name);
    for (int i = 0; i < 12; ++i)
      test::write_image(folder / name / (std::to_string(i) + ".png"), uint64_t(i));
  }
  const std::vector<std::string> words = {"--scores",        write_scores(folder),
                                          "--distance",      "--ground-truth",
                                          "aligned",         "--query",
                                          folder / "q",      "--train",
                                          folder / "r",      "--html",
                                          folder / "e.html", "--plot",
                                          folder / "plots"};
  const auto run = run_program("vpr-eval", words);
  CHECK(run.exit_code == 0);
  const std::string page = test::read_text(folder / "e.html");
  CHECK(page.find("s on q") != std::string::npos);
  CHECK(page.find("true place references 9: 9.png") != std::string::npos);
  CHECK(test::list_folder(folder / "plots") ==
        std::vector<std::string>{".vpr-files", "matrix.png", "matrix.svg", "precision-recall.png",
                                 "precision-recall.svg", "recall-at.png", "recall-at.svg",
                                 "risk-coverage.png", "risk-coverage.svg", "timeline.png",
                                 "timeline.svg"});
  CHECK(
      run.out.rfind("Best match right in 9 of 12 frames (75.0 %); 4 before the first mistake, at a "
                    "threshold chosen from the ground truth.\n",
                    0) == 0);
  CHECK(page.find("Best match right in 9 of 12 frames") != std::string::npos);
  CHECK(page.find("Recognised in") == std::string::npos);
  CHECK(run_program("vpr-eval", words).exit_code == 2);  // the page exists
  auto other = words;
  other[8] = folder / "q/1.png";
  other.emplace_back("--force");
  CHECK(run_program("vpr-eval", other).exit_code != 0);
}

TEST_CASE("reports are compared query by query") {
  const test::TemporaryFolder folder;
  std::vector<float> worse(144, 20);
  for (size_t q = 0; q < 6; ++q) worse[13 * q] = float(q + 1);
  Output file(folder / "w.npy", Existing::replace);
  write_npy<float>(file, worse, {12, 12});
  file.commit();
  for (const std::string& scores : {write_scores(folder), std::string(folder / "w.npy")})
    REQUIRE(run_program("vpr-eval", {"--scores", scores, "--distance", "--ground-truth", "aligned",
                                     "-o", scores + ".json", "--quiet"})
                .exit_code == 0);
  const std::vector<std::string> words = {"compare", folder / "s.npy.json", folder / "w.npy.json"};
  auto json_words = words;
  json_words.insert(json_words.end(), {"--json", "-o", folder / "c.json"});
  const Json found = report_of(json_words);
  CHECK(found["schema"] == "vpr.comparison/1");
  CHECK(found["metrics"][1]["report"] == "w");
  CHECK(found["metrics"][1]["difference"].get<double>() == Approx(-3.0 / 12));
  CHECK(found["paired"][0]["only_first"] == 3);
  const auto text = run_program("vpr-eval", words);
  CHECK(text.out.find("differences to s over 12 common queries") != std::string::npos);
  CHECK(run_program("vpr-eval", {"compare", folder / "s.npy.json"}).exit_code == 2);
  CHECK(run_program("vpr-eval", {"compare", folder / "s.npy", folder / "w.npy"}).exit_code == 4);
  CHECK(run_program("vpr-eval", {"compare", folder / "a.json", folder / "b.json"}).exit_code == 3);
}

TEST_CASE("damaged reports are refused") {
  const test::TemporaryFolder folder;
  const Json good =
      report_of({"--scores", write_scores(folder), "--distance", "--ground-truth", "aligned"});
  test::write_text(folder / "good.json", good.dump());
  const auto code = [&](const std::string& key, const Json& value) {
    Json bad = good;
    bad["outcomes"][key] = value;
    test::write_text(folder / "bad.json", bad.dump());
    return run_program("vpr-eval", {"compare", folder / "good.json", folder / "bad.json"})
        .exit_code;
  };
  CHECK(code("best", "cccccccccwww") == 0);
  CHECK(code("best", "ccccccccxwww") == 4);
  CHECK(code("best", "c") == 4);
  CHECK(code("best", 3) == 4);
  CHECK(code("scores", "1 2 3") == 4);
  CHECK(code("scores", "1 2 3 4 5 6 7 8 9 10 11 x") == 4);
  CHECK(code("ranks", "1 2 3 4 5 6 7 8 9 10 11 -1") == 4);
  CHECK(code("first_frame", -1) == 4);
  CHECK(code("scores_are", "votes") == 4);
  Json old = good;
  old.erase("outcomes");
  test::write_text(folder / "old.json", old.dump());
  CHECK(run_program("vpr-eval", {"compare", folder / "good.json", folder / "old.json"}).exit_code ==
        4);
}

TEST_CASE("reports with different ground truths are not compared, unless it is asked for") {
  const test::TemporaryFolder folder;
  const std::string scores = write_scores(folder);
  test::write_text(folder / "g.csv", "query,reference\n0,0\n1,1\n2,3\n11,11\n");
  std::string same = "query,reference\n";
  for (int i = 0; i < 12; ++i) same += std::to_string(i) + "," + std::to_string(i) + "\n";
  test::write_text(folder / "same.csv", same);
  for (const auto& [name, truth] : std::vector<std::pair<std::string, std::string>>{
           {"a", "aligned"}, {"b", folder / "g.csv"}, {"c", folder / "same.csv"}})
    REQUIRE(run_program("vpr-eval", {"--scores", scores, "--distance", "--ground-truth", truth,
                                     "-o", folder / (name + ".json"), "--quiet"})
                .exit_code == 0);
  const auto refused = run_program("vpr-eval", {"compare", folder / "a.json", folder / "b.json"});
  CHECK(refused.exit_code == 4);
  CHECK(refused.err.find("--allow-different") != std::string::npos);
  const auto allowed = run_program("vpr-eval", {"compare", folder / "a.json", folder / "b.json",
                                                "--allow-different", "-o", folder / "d.json"});
  CHECK(allowed.exit_code == 0);
  CHECK(allowed.out.find("ground truths: different") != std::string::npos);
  const Json found = Json::parse(test::read_text(folder / "d.json"));
  CHECK(found["ground_truths"] == "different");
  CHECK(found["queries"]["disputed"] == 8);
  CHECK(found["queries"]["common"] == 4);
  // The same pairs in another format are the same ground truth.
  CHECK(report_of({"compare", folder / "a.json", folder / "c.json"})["ground_truths"] == "same");
  Json damaged = Json::parse(test::read_text(folder / "b.json"));
  damaged["provenance"].erase("ground_truth");
  test::write_text(folder / "damaged.json", damaged.dump());
  const auto unknown =
      run_program("vpr-eval", {"compare", folder / "a.json", folder / "damaged.json", "--json"});
  CHECK(unknown.exit_code == 4);
  CHECK(unknown.err.find("\"ground_truth\" is missing") != std::string::npos);
}

TEST_CASE("names that users give stay, and only automatic ones that clash make way") {
  const test::TemporaryFolder folder;
  const std::string scores = write_scores(folder);
  for (const auto& [file, name] :
       std::vector<std::pair<std::string, std::string>>{{"a", "MyNet"}, {"b", ""}, {"c", ""}}) {
    std::vector<std::string> words = {"--scores",
                                      scores,
                                      "--distance",
                                      "--ground-truth",
                                      "aligned",
                                      "-o",
                                      folder / (file + ".json"),
                                      "--quiet"};
    if (!name.empty()) words.insert(words.end(), {"--name", name});
    REQUIRE(run_program("vpr-eval", words).exit_code == 0);
  }
  const auto names = [&](const std::vector<std::string>& files) {
    std::vector<std::string> words = {"compare"};
    for (const std::string& file : files) words.push_back(folder / (file + ".json"));
    const Json compared = report_of(words);
    std::vector<std::string> found;
    for (const Json& report : compared["reports"])
      found.push_back(report["name"].get<std::string>());
    return found;
  };
  CHECK(names({"a", "b"}) == std::vector<std::string>{"MyNet", "s"});
  CHECK(names({"a", "b", "c"}) == std::vector<std::string>{"MyNet", "b", "c"});
  CHECK(names({"b", "a", "b"}) == std::vector<std::string>{"b (1)", "MyNet", "b (3)"});
  CHECK(names({"a", "a"}) == std::vector<std::string>{"MyNet (1)", "MyNet (2)"});
}

TEST_CASE("single queries are written as rows for data frames") {
  const test::TemporaryFolder folder;
  const std::vector<std::string> words = {
      "--scores", write_scores(folder), "--distance",    "--ground-truth", "aligned", "--name",
      "a,b",      "--outcomes-csv",     folder / "o.csv"};
  REQUIRE(run_program("vpr-eval", words).exit_code == 0);
  const std::string text = test::read_text(folder / "o.csv");
  CHECK(text.starts_with(
      "name,query,first_frame,frame,sequence,train_frame,score,outcome,has_match,fix,rank,"
      "margin\n\"a,b\",queries,0,0,references,0,1,right,yes,right,1,\n"));
  CHECK(text.find("\"a,b\",queries,11,11,references,0,11,wrong,yes,none,") != std::string::npos);
  CHECK(std::count(text.begin(), text.end(), '\n') == 13);
  CHECK(run_program("vpr-eval", words).exit_code == 2);  // it exists
  auto places = words;
  places[7] = "--recognitions-csv";
  places[8] = folder / "r.csv";
  CHECK(run_program("vpr-eval", places).exit_code == 2);
}

TEST_CASE("a tolerance below 0 is refused in a sentence") {
  const test::TemporaryFolder folder;
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--scores", write_scores(folder), "--distance", "--ground-truth",
                                 "aligned", "--tolerance", "-1"},
        {"check", "aligned", "--tolerance", "-1", "--query-frames", "3", "--train-frames", "3"}}) {
    const auto run = run_program("vpr-eval", words);
    CHECK(run.exit_code == 2);
    CHECK(run.err.find("must be 0 frames or more, found -1") != std::string::npos);
  }
}

TEST_CASE("a pose that is missing costs the metres and nothing else") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "p.csv", "frame,x,y\n0,0,0\n2,1,1\n");
  const auto run =
      run_program("vpr-eval", {"--scores", write_scores(folder), "--distance", "--ground-truth",
                               "aligned", "--poses", folder / "p.csv", "--json"});
  CHECK(run.exit_code == 0);
  CHECK(run.err.find("no pose of 10 of 12 frames") != std::string::npos);
  CHECK(Json::parse(run.out)["localisation"]["longest_gap_m"].is_null());
}
