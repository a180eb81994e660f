// vpr-eval on scores of other programs, and comparisons of its reports.
#include <algorithm>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

/// Twelve queries and twelve references, aligned: queries 0 to 8 are correct with distances 1 to 9,
/// queries 9 to 11 prefer reference 0 with distances 4.5, 10 and 11.
std::string write_scores(const TemporaryFolder& folder, const std::string& name = "s.npy",
                         double sign = 1) {
  std::vector<float> scores(144, float(20 * sign));
  for (size_t q = 0; q < 9; ++q) scores[13 * q] = float(sign * double(q + 1));
  scores[9 * 12] = float(4.5 * sign);
  scores[10 * 12] = float(10 * sign);
  scores[11 * 12] = float(11 * sign);
  write_array(folder / name, scores, {12, 12});
  return folder / name;
}

/// The arguments that evaluate these scores.
Words scored(const TemporaryFolder& folder, const Words& more = {}) {
  return joined({"matrix", write_scores(folder), "--distance", "--ground-truth", "aligned"}, more);
}

Json report_of(const Words& words) {
  const auto run = run_program("vpr-eval", joined(words, {"--json"}));
  REQUIRE(run.err.empty());
  REQUIRE(run.exit_code == 0);
  return Json::parse(run.out);
}

/// Ten queries and ten references, aligned; the first `right` are correct, earlier ones closer; all
/// others prefer reference 0.
std::string report_of(const TemporaryFolder& folder, const std::string& name, size_t right) {
  std::vector<float> scores(100, 50);
  for (size_t q = 0; q < 10; ++q) scores[q < right ? 11 * q : 10 * q] = float(q + 1);
  write_array(folder / (name + ".npy"), scores, {10, 10});
  const std::string report = folder / (name + ".json");
  run_ok("vpr-eval", {"matrix", folder / (name + ".npy"), "--distance", "--ground-truth", "aligned",
                      "-o", report, "--quiet"});
  return report;
}

}  // namespace

TEST_CASE("scores of any program are evaluated with the field's metrics") {
  const TemporaryFolder folder;
  const Json report = report_of(scored(folder));
  CHECK(report["method"] == "s");
  CHECK(report["best_match"]["frames"] == 12);
  CHECK(report["best_match"]["correct"] == 9);
  const Json& single = report["metrics"]["single_best"];
  CHECK(single["positives"] == 12);
  // Four correct ones, the incorrect one at 4.5, five more correct ones.
  const double expected = (4 + 5 / 6.0 + 6 / 7.0 + 7 / 8.0 + 8 / 9.0 + 9 / 10.0) / 12;
  CHECK(single["average_precision"].get<double>() == Approx(expected));
  CHECK(single["recall_at_100_precision"].get<double>() == Approx(4 / 12.0));
  CHECK(single["thresholds"]["recall_at_100_precision"] == 4);
  CHECK(report["metrics"]["recall_at"]["1"] == 0.75);
  // All references after the closest one tie; the first one comes first.
  CHECK(report["metrics"]["recall_at"]["5"] == 0.75);
  CHECK(report["metrics"]["recall_at"]["10"].get<double>() == Approx(10 / 12.0));
  CHECK(report["metrics"]["recall_at"]["20"] == 1);
  CHECK(report["localization"]["correct"] == 4);
  CHECK(report["localization"]["longest_gap_frames"] == 8);
  CHECK(report["outcomes"]["best"] == "cccccccccwww");
}

TEST_CASE("similarities and a user's threshold are evaluated") {
  const TemporaryFolder folder;
  const std::string turned = write_scores(folder, "t.npy", -1);
  const Json report = report_of({"matrix", turned, "--similarity", "--ground-truth", "aligned",
                                 "--threshold", "-5", "--name", "mine"});
  CHECK(report["method"] == "mine");
  CHECK(report["metrics"]["single_best"]["max_f1"] ==
        report_of(scored(folder))["metrics"]["single_best"]["max_f1"]);
  CHECK(report["localization"]["correct"] == 5);
  CHECK(report["localization"]["incorrect"] == 1);
  CHECK_FALSE(report.contains("oracle"));
  const auto text = run_program("vpr-eval", {"matrix", turned, "--similarity", "--ground-truth",
                                             "aligned", "--threshold", "-5"});
  CHECK(text.out.starts_with(
      "Best match correct in 9 of 12 frames (75.0 %). 6 of 12 frames recognized, 1 of\nthem "
      "incorrectly. The first is confirmed at frame 0.\n"));
}

TEST_CASE("an operating point from the ground truth is not compared with a chosen one") {
  const TemporaryFolder folder;
  const std::string scores = write_scores(folder);
  const auto report = [&](const std::string& name, const Words& more) {
    run_ok("vpr-eval", joined({"matrix", scores, "--distance", "--name", name, "--ground-truth",
                               "aligned", "-o", folder / (name + ".json"), "--quiet"},
                              more));
    return (folder / (name + ".json")).string();
  };
  // The fixed threshold has 7 of 12 correct and the one at 4.5 incorrect; the best possible one has
  // 4 of 12.
  const std::string fixed = report("fixed", {"--threshold", "7"});
  const std::string oracle = report("oracle", {});
  const std::string late = report("late", {"--threshold", "2"});
  const auto text = run_program("vpr-eval", {"compare", oracle, late, fixed}).out;
  CHECK(has(text, "oracle: threshold from the ground truth"));
  CHECK(has(text, "\noracle  0.7500*  0.7500*  0.6962*  0.3333*        -          -\n"));
  CHECK(has(text, "\nfixed   0.7500*  0.7500*  0.6962*  0.3333*        7          1\n"));
  CHECK(has(run_program("vpr-eval", {"compare", oracle, late, fixed, "-v"}).out, "0.5833*"));
  const std::string csv =
      run_program("vpr-eval", {"compare", oracle, late, fixed, "--format", "csv"}).out;
  CHECK(has(csv, "queries,fixed,,same,incorrect,1,"));
  // Next to a chosen threshold with fewer, the best possible one is not marked; otherwise it may
  // be.
  const auto less = run_program("vpr-eval", {"compare", oracle, late, "--format", "markdown"}).out;
  CHECK(has(less, "| 0.3333 | 0 | 8 |"));
  const auto both = run_program("vpr-eval", {"compare", oracle, oracle, "--format", "markdown"});
  CHECK(has(both.out, "| **0.3333** | 0 | **8** |"));
}

TEST_CASE("the headline of lists without confidence is the number of correct ones") {
  const TemporaryFolder folder;
  write_text(folder / "pairs.txt", "0 0\n1 1\n2 5\n3 3\n");
  const auto run =
      run_program("vpr-eval", {"matrix", folder / "pairs.txt", "--ground-truth", "aligned"});
  INFO(run.err);
  CHECK(run.out.starts_with("Best match correct in 3 of 4 frames (75.0 %).\n"));
}

TEST_CASE("a result is summed up in 12 lines of 80 columns, with its incorrect ranges") {
  const TemporaryFolder out;
  run_ok("vpr-query", {world().database(), "--query", world().walk("back"), "--c-l", "3", "--t-r",
                       "0.9", "-o", out / "r.json", "--quiet"});
  write_text(out / "pairs.csv", "query,sequence,reference\n0,one,0\n1,one,1\n2,one,2\n");
  const auto run = run_program("vpr-eval", {out / "r.json", "--ground-truth", out / "pairs.csv"});
  INFO(run.out);
  const Words lines = lines_of(run.out);
  CHECK(lines.size() <= 12);
  CHECK(std::ranges::all_of(lines, [](const std::string& line) { return line.size() <= 80; }));
  CHECK(run.out.starts_with("1 of 3 frames with a match recognized, 1 of them incorrectly;"));
  CHECK(has(run.out, "\n  settings      fastable, c_l 3, raw, t_r 0.9 relative\n"));
  CHECK(has(run.out, ": incorrect"));
  CHECK(has(run.out, "next: compare methods with\n  vpr-tune " + world().database()));
  const auto silent = run_program("vpr-eval", {out / "r.json", "--html", out / "e.html"});
  CHECK(has(silent.out, "Nothing is judged"));
  CHECK(has(silent.out, "next: judge each place by its images with --ask-places PAGE.html\n"));
}

TEST_CASE("incorrect recognitions within a larger tolerance are named") {
  const TemporaryFolder folder;
  std::vector<float> scores(400, 50);
  for (size_t q = 0; q < 20; ++q) scores[20 * q + (q < 18 ? q : q - 2)] = float(q + 1);
  write_array(folder / "s.npy", scores, {20, 20});
  const Words words = {"matrix", folder / "s.npy", "--distance", "--ground-truth", "aligned"};
  CHECK(run_program("vpr-eval", words).err ==
        "warning: all 2 incorrect best matches are within 2 frames of the truth\n");
  CHECK(run_program("vpr-eval", joined(words, {"--tolerance", "2"})).err.empty());
}

TEST_CASE("each command of vpr-eval has its own flags") {
  const auto help = [](const std::string& command) {
    return run_ok("vpr-eval", command.empty() ? Words{"--help"} : Words{command, "--help"}).out;
  };
  CHECK_FALSE(has(help(""), "--similarity"));
  CHECK_FALSE(has(help("matrix"), "--map"));
  CHECK_FALSE(has(help("loops"), "--ground-truth"));
}

TEST_CASE("reports of one query with several names are in one table") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "all");
  write_text(folder / "q.txt", [] {
    std::string names;
    for (int i = 0; i < 12; ++i) names += fmt::format("{}.png\n", i);
    return names;
  }());
  run_ok("vpr-eval", scored(folder, {"-o", folder / "all/a.json", "--name", "a"}));
  const auto named =
      scored(folder, {"-o", folder / "all/b.json", "--name", "b", "--query", folder / "q.txt"});
  run_ok("vpr-eval", named);
  const auto run = run_ok("vpr-eval", {"report", folder / "all"});
  CHECK(has(run.out, "\na  "));
  CHECK(has(run.out, "\nb  "));
  CHECK_FALSE(has(run.out, "queries: R@1"));
  CHECK(has(run.out, "over 12 frames with a match\n"));
}

TEST_CASE("positions yield gaps in meters") {
  const TemporaryFolder folder;
  std::string poses = "frame,x,y\n";
  for (int i = 0; i < 12; ++i) poses += std::to_string(i) + "," + std::to_string(2 * i) + ",0\n";
  write_text(folder / "p.csv", poses);
  const Json report = report_of(scored(folder, {"--poses", folder / "p.csv"}));
  CHECK(report["localization"]["longest_gap_m"] == 16);
  CHECK(report["localization"]["first_recognition_m"] == 0);
}

TEST_CASE("metrics can be expected") {
  const TemporaryFolder folder;
  write_text(folder / "x.json", R"({"schema": "vpr.expected/4", "metrics":
      {"recall_at": {"1": {"value": 0.8, "tolerance": 0.01}}}})");
  const auto run = run_program("vpr-eval", scored(folder, {"--expect", folder / "x.json"}));
  CHECK(run.exit_code == 5);
  CHECK(has(run.err, "metrics.recall_at.1: expected 0.8 +- 0.01, found 0.75"));
  write_text(folder / "y.json", R"({"schema": "vpr.expected/4", "counts": {"distinct": 3}})");
  CHECK(run_program("vpr-eval", scored(folder, {"--expect", folder / "y.json"})).exit_code == 2);
}

TEST_CASE("invalid scores exit with their code and one sentence") {
  const TemporaryFolder folder;
  const std::string scores = write_scores(folder);
  write_text(folder / "text.npy", "no array");
  const auto code = [](Words words) {
    const auto run = run_program("vpr-eval", joined(words, {"--ground-truth", "aligned"}));
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    return run.exit_code;
  };
  CHECK(code({}) == 2);
  CHECK(code({"matrix", scores}) == 2);
  CHECK(code({"matrix", scores, "--distance", "--similarity"}) == 2);
  CHECK(code({"matrix", scores, "--distance", "--rows-are-windows-of", "0"}) == 2);
  CHECK(code({"matrix", scores, "--distance", "--rows-are-windows-of", "18446744073709551615"}) ==
        2);
  CHECK(run_program("vpr-eval", {"r.json", "--protocol", "nordland-exact", "--html", "x.html"})
            .exit_code == 2);
  CHECK(code({"r.json", "--distance"}) == 2);
  CHECK(code({"r.json", "--rows-are-windows-of", "3"}) == 2);
  CHECK(code({"matrix", folder / "none.npy", "--distance"}) == 3);
  CHECK(code({"matrix", folder / "text.npy", "--distance"}) == 4);
  CHECK(code({"matrix", scores, "--distance", "--poses", folder / "text.npy"}) == 4);
}

TEST_CASE("CSV has everything in one row, and -v prints one table each after a short text") {
  const TemporaryFolder folder;
  const Words words = scored(folder);
  const std::string row = run_program("vpr-eval", joined(words, {"--format", "csv"})).out;
  CHECK(std::count(row.begin(), row.end(), '\n') == 2);
  CHECK(has(row, "best AP,"));
  CHECK(has(row, "pairs AP,"));
  CHECK(has(row, "R@10,"));
  const std::string brief = run_program("vpr-eval", words).out;
  CHECK(has(brief, "\n  recall        R@1 0.7500, R@5 0.7500, R@10 0.8333, R@20 1.0000\n"));
  CHECK(has(brief, "\n  curve         AP 0.6962, R@100P 0.3333\n"));
  const Words lines = lines_of(brief);
  CHECK(lines.size() <= 12);
  CHECK(std::ranges::all_of(lines, [](const std::string& line) { return line.size() <= 80; }));
  CHECK_FALSE(has(brief, "Recall@K"));
  const std::string text = run_program("vpr-eval", joined(words, {"-v"})).out;
  CHECK(text.starts_with(brief));
  CHECK(has(text, "Recall@K"));
  CHECK(has(text, "Metrics over 12 frames with a match (0 without an answer"));
}

TEST_CASE("images: a page with the frames of both sequences, and plots") {
  const TemporaryFolder folder;
  for (const std::string name : {"q", "r"}) {
    fs::create_directory(folder / name);
    for (int i = 0; i < 12; ++i)
      write_image(folder / name / (std::to_string(i) + ".png"), uint64_t(i));
  }
  const auto words = [&](const fs::path& query) {
    return scored(folder, {"--query", query, "--train", folder / "r", "--html", folder / "e.html",
                           "--plot", folder / "plots"});
  };
  const auto run = run_ok("vpr-eval", words(folder / "q"));
  const std::string page = read_text(folder / "e.html");
  CHECK(has(page, "s on q"));
  CHECK(has(page, "true place references 9: 9.png"));
  CHECK(list_folder(folder / "plots") ==
        Words{".vpr-files", "matrix.png", "matrix.svg", "precision-recall.png",
              "precision-recall.svg", "recall-at.png", "recall-at.svg", "risk-coverage.png",
              "risk-coverage.svg", "timeline.png", "timeline.svg"});
  CHECK(run.out.starts_with(
      "Best match correct in 9 of 12 frames (75.0 %); 4 frames can be accepted before\n"
      "the first mistake (threshold chosen with the ground truth).\n"));
  CHECK(has(page, "Best match correct in 9 of 12 frames"));
  CHECK_FALSE(has(page, "frames recognized"));
  CHECK(run_program("vpr-eval", words(folder / "q")).exit_code == 2);  // the page exists
  CHECK(run_program("vpr-eval", joined(words(folder / "q/1.png"), {"--force"})).exit_code != 0);
}

TEST_CASE("reports are compared query by query") {
  const TemporaryFolder folder;
  std::vector<float> worse(144, 20);
  for (size_t q = 0; q < 6; ++q) worse[13 * q] = float(q + 1);
  write_array(folder / "w.npy", worse, {12, 12});
  for (const std::string& scores : {write_scores(folder), std::string(folder / "w.npy")})
    run_ok("vpr-eval", {"matrix", scores, "--distance", "--ground-truth", "aligned", "-o",
                        scores + ".json", "--quiet"});
  const Words words = {"compare", folder / "s.npy.json", folder / "w.npy.json"};
  const Json found = report_of(joined(words, {"--json", "-o", folder / "c.json"}));
  CHECK(found["schema"] == "vpr.comparison/4");
  CHECK(found["metrics"][1]["report"] == "w.npy");
  CHECK(found["metrics"][1]["difference"].get<double>() == Approx(-3.0 / 12));
  CHECK(found["paired"][0]["only_first"] == 3);
  const auto text = run_program("vpr-eval", words);
  CHECK(text.out.starts_with("Highest R@1, over 12 frames with a match: s.npy.\n"));
  CHECK(has(text.out, "\nw.npy - s.npy: R@1 -0.2500 (95 %: "));
  CHECK_FALSE(has(text.out, "differences to s.npy"));
  CHECK(has(run_program("vpr-eval", joined(words, {"-v"})).out,
            "differences to s.npy over 12 frames with a match"));
  CHECK(run_program("vpr-eval", {"compare", folder / "s.npy.json"}).exit_code == 2);
  CHECK(run_program("vpr-eval", {"compare", folder / "s.npy", folder / "w.npy"}).exit_code == 4);
  CHECK(run_program("vpr-eval", {"compare", folder / "a.json", folder / "b.json"}).exit_code == 3);
}

TEST_CASE("damaged reports are refused") {
  const TemporaryFolder folder;
  const Json good = report_of(scored(folder));
  write_text(folder / "good.json", good.dump());
  const auto code = [&](const std::string& key, const Json& value) {
    Json bad = good;
    bad["outcomes"][key] = value;
    write_text(folder / "bad.json", bad.dump());
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
  CHECK(code("score_order", "votes") == 4);
  CHECK(code("recognized", "rrr") == 4);
  CHECK(code("recognized", "rrrrrrrrrrrx") == 4);
  Json old = good;
  old.erase("outcomes");
  write_text(folder / "old.json", old.dump());
  CHECK(run_program("vpr-eval", {"compare", folder / "good.json", folder / "old.json"}).exit_code ==
        4);
}

TEST_CASE("reports with different ground truths are compared only on request") {
  const TemporaryFolder folder;
  const std::string scores = write_scores(folder);
  write_text(folder / "g.csv", "query,reference\n0,0\n1,1\n2,3\n11,11\n");
  std::string same = "query,reference\n";
  for (int i = 0; i < 12; ++i) same += std::to_string(i) + "," + std::to_string(i) + "\n";
  write_text(folder / "same.csv", same);
  for (const auto& [name, truth] : std::vector<std::pair<std::string, std::string>>{
           {"a", "aligned"}, {"b", folder / "g.csv"}, {"c", folder / "same.csv"}})
    run_ok("vpr-eval", {"matrix", scores, "--distance", "--ground-truth", truth, "-o",
                        folder / (name + ".json"), "--quiet"});
  check_failure("vpr-eval", {"compare", folder / "a.json", folder / "b.json"}, 4,
                "--allow-different");
  const auto allowed = run_ok("vpr-eval", {"compare", folder / "a.json", folder / "b.json",
                                           "--allow-different", "-v", "-o", folder / "d.json"});
  CHECK(has(allowed.out, "ground truths: different"));
  const Json found = file_json(folder / "d.json");
  CHECK(found["ground_truths"] == "different");
  CHECK(found["frames"]["disputed"] == 8);
  CHECK(found["frames"]["compared"] == 4);
  // The same pairs in another format are equal ground truth.
  CHECK(report_of({"compare", folder / "a.json", folder / "c.json"})["ground_truths"] == "same");
  Json damaged = file_json(folder / "b.json");
  damaged["provenance"].erase("ground_truth");
  write_text(folder / "damaged.json", damaged.dump());
  const auto unknown =
      run_program("vpr-eval", {"compare", folder / "a.json", folder / "damaged.json", "--json"});
  CHECK(unknown.exit_code == 4);
  CHECK(has(unknown.err, "\"ground_truth\" is missing"));
}

TEST_CASE("names set by the user stay, and only conflicting automatic names change") {
  const TemporaryFolder folder;
  for (const std::string file : {"a", "b", "c"})
    run_ok("vpr-eval", joined(scored(folder, {"-o", folder / (file + ".json"), "--quiet"}),
                              file == "a" ? Words{"--name", "MyNet"} : Words{}));
  const auto names = [&](const Words& files) {
    Words words = {"compare"};
    for (const std::string& file : files) words.push_back(folder / (file + ".json"));
    const Json compared = report_of(words);
    Words found;
    for (const Json& report : compared["reports"])
      found.push_back(report["name"].get<std::string>());
    return found;
  };
  CHECK(names({"a", "b"}) == Words{"MyNet", "b"});
  CHECK(names({"a", "b", "c"}) == Words{"MyNet", "b", "c"});
  CHECK(names({"b", "a", "b"}) == Words{"b (1)", "MyNet", "b (3)"});
  CHECK(names({"a", "a"}) == Words{"MyNet (1)", "MyNet (2)"});
}

TEST_CASE("single queries are written as rows for data frames") {
  const TemporaryFolder folder;
  const auto words = [&](const std::string& flag, const std::string& name) {
    return scored(folder, {"--name", "a,b", flag, folder / name});
  };
  run_ok("vpr-eval", words("--outcomes-csv", "o.csv"));
  const std::string text = read_text(folder / "o.csv");
  CHECK(text.starts_with(
      "name,query,first_frame,frame,sequence,train_frame,score,outcome,has_match,recognition,rank,"
      "margin\n\"a,b\",queries,0,0,references,0,1,correct,yes,correct,1,\n"));
  CHECK(has(text, "\"a,b\",queries,11,11,references,0,11,incorrect,yes,none,"));
  CHECK(std::count(text.begin(), text.end(), '\n') == 13);
  CHECK(run_program("vpr-eval", words("--outcomes-csv", "o.csv")).exit_code == 2);  // it exists
  CHECK(run_program("vpr-eval", words("--recognitions-csv", "r.csv")).exit_code == 2);
}

TEST_CASE("a negative tolerance is refused in one sentence") {
  const TemporaryFolder folder;
  for (const Words& words :
       {scored(folder, {"--tolerance", "-1"}),
        {"check", "aligned", "--tolerance", "-1", "--query-frames", "3", "--train-frames", "3"}}) {
    check_failure("vpr-eval", words, 2, "must be 0 frames or more, found -1");
  }
}

TEST_CASE("a missing pose disables only the distances in meters") {
  const TemporaryFolder folder;
  write_text(folder / "p.csv", "frame,x,y\n0,0,0\n2,1,1\n");
  const auto run = run_ok("vpr-eval", scored(folder, {"--poses", folder / "p.csv", "--json"}));
  CHECK(has(run.err, "no pose for 10 of 12 frames"));
  CHECK(Json::parse(run.out)["localization"]["longest_gap_m"].is_null());
}

TEST_CASE("the table of a paper has a row for each method, with the best values in bold") {
  const TemporaryFolder folder;
  const std::string good = report_of(folder, "good", 8);
  const std::string bad = report_of(folder, "bad", 4);
  const auto table = [&](const std::string& format) {
    const auto run = run_program("vpr-eval", {"compare", good, bad, "--name", "ours & yours",
                                              "--name", "theirs", "--format", format});
    CHECK(run.err.empty());
    REQUIRE(run.exit_code == 0);
    return run.out;
  };
  // 8 of ten positives are correct, and the first 8 accepted ones: AP = R@100P = 0.8, and max F1 =
  // 16 / (8 + 10). R@5 and R@10 count ties of the first rank.
  const std::string text = table("text");
  CHECK(has(text, "ours & yours  0.8000*"));
  CHECK(has(text, "theirs        0.4000 "));
  CHECK_FALSE(has(text, "longest gap"));
  CHECK(has(table("latex"), "ours \\& yours & \\textbf{0.8000}"));
  CHECK(has(table("latex"), "\\label{tab:comparison}"));
  CHECK(has(table("markdown"), "| theirs | 0.4000 |"));
  const std::string csv = table("csv");
  CHECK(csv.starts_with(
      "query,report,selection,ground_truths,metric,value,difference,low,high,verdict\n"));
  CHECK(has(csv, "queries,theirs,,same,recall_at_1,0.4,-0.4,"));
  CHECK(has(csv, "queries,theirs,,same,longest_gap_frames,6,"));
  CHECK(run_program("vpr-eval", {"compare", good, bad, "--name", "one"}).exit_code == 2);
}

TEST_CASE("curves and paths of all methods are on one page and in one plot") {
  const TemporaryFolder folder;
  run_ok("vpr-eval", {"compare", report_of(folder, "<good>", 8), report_of(folder, "bad", 4),
                      "--html", folder / "c.html", "--plot", folder / "plots"});
  const std::string page = read_text(folder / "c.html");
  CHECK(has(page,
            "Best matches of 10 frames are correct in 80.0 % by &lt;good&gt;, 40.0 % "
            "by bad."));
  CHECK(has(page, "<b>0.8000</b>"));
  CHECK(has(page, "class=\"line series-1\""));
  CHECK(has(page, "stroke-dasharray:9 4"));  // methods differ without color
  CHECK(page.find("<svg class=\"lanes wide\"") < page.find("<table"));
  CHECK(has(page, "<dt>R@1</dt><dd>-0.4000\n"));  // one row per method after the first
  CHECK_FALSE(has(page, "recall_at_100_precision"));
  CHECK_FALSE(has(page, "http:"));
  CHECK(list_folder(folder / "plots") == Words{".vpr-files", "lanes.png", "lanes.svg",
                                               "precision-recall.png", "precision-recall.svg"});
}

TEST_CASE("a resampled query is compared with the query over its own frames") {
  const TemporaryFolder out;
  const auto evaluate = [&](const std::string& name, const Words& more) {
    run_ok("vpr-query", joined({world().database(), "--dataset", world().dataset(), "--c-l", "1",
                                "--t-r", "0.3", "-o", out / (name + ".r.json")},
                               more));
    run_ok("vpr-eval", {out / (name + ".r.json"), "--dataset", world().dataset(), "-o",
                        out / (name + ".json"), "--quiet"});
    return (out / (name + ".json")).string();
  };
  const std::string plain = evaluate("plain", {});
  const std::string slow = evaluate("slow", {"--speed", "0.5"});
  const Json found = printed_json("vpr-eval", {"compare", plain, slow, "--json"});
  CHECK(found["ground_truths"] == "same");
  CHECK(found["reports"][1]["paired"] == false);
  CHECK(found["reports"][1]["selection"] == "speed 0.5, seed 1");
  CHECK(found["reports"][1]["frames"] == 2 * found["reports"][0]["frames"].get<int>());
  CHECK(found["paired"].empty());
  // Every frame is shown twice: the shares are equal.
  CHECK(found["metrics"][1]["value"] == found["metrics"][0]["value"]);
  CHECK(found["metrics"][1]["difference"] == 0);
  CHECK(found["metrics"][1]["low"].is_null());
  CHECK(has(run_ok("vpr-eval", {"compare", plain, slow, "--html", out / "c.html"}).out,
            "not paired, over"));
  CHECK(has(read_text(out / "c.html"), "% by plain."));  // the other one has other queries
  // Equal resampled queries are paired.
  CHECK(printed_json("vpr-eval", {"compare", slow, slow, "--json"})["paired"].size() == 1);
}
