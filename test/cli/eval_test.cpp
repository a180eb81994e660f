// vpr-eval on scores of other programs, and comparisons of its reports.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

/// Twelve queries and twelve references, aligned: queries 0 to 8 are correct with distances 1 to 9,
/// queries 9 to 11 prefer reference 0 with distances 4.5, 10 and 11.
std::string write_scores(const std::string& name = "s.npy", double sign = 1) {
  std::vector<float> scores(144, float(20 * sign));
  for (size_t q = 0; q < 9; ++q) scores[13 * q] = float(sign * double(q + 1));
  scores[9 * 12] = float(4.5 * sign);
  scores[10 * 12] = float(10 * sign);
  scores[11 * 12] = float(11 * sign);
  write_array(name, scores, {12, 12});
  return name;
}

const std::string kAligned = " --distance --ground-truth aligned ";

/// The command that evaluates these scores.
std::string scored(const std::string& more = "") {
  return "vpr-eval matrix " + write_scores() + kAligned + more;
}

Json report_of(const std::string& command) {
  const auto outcome = run_ok(command + " --json");
  CHECK(outcome.err.empty());
  return Json::parse(outcome.out);
}

/// Ten queries and ten references, aligned; the first `right` are correct, earlier ones closer; all
/// others prefer reference 0. Writes the report NAME.json.
void write_report(const std::string& name, size_t right) {
  std::vector<float> scores(100, 50);
  for (size_t q = 0; q < 10; ++q) scores[q < right ? 11 * q : 10 * q] = float(q + 1);
  write_array(name + ".npy", scores, {10, 10});
  run_ok("vpr-eval matrix " + name + ".npy" + kAligned + "--quiet -o " + name + ".json");
}

}  // namespace

TEST_CASE("similarities and a user's threshold are evaluated") {
  write_scores("t.npy", -1);
  const std::string turned =
      "vpr-eval matrix t.npy --similarity --ground-truth aligned --threshold -5";
  const Json report = report_of(turned + " --name mine");
  CHECK(report["method"] == "mine");
  CHECK(report["metrics"]["single_best"]["max_f1"] ==
        report_of(scored())["metrics"]["single_best"]["max_f1"]);
  CHECK(report["localization"]["correct"] == 5);
  CHECK(report["localization"]["incorrect"] == 1);
  CHECK_FALSE(report.contains("oracle"));
  CHECK(run_ok(turned).out.starts_with(
      "Best match correct in 9 of 12 frames (75.0 %). 6 of 12 frames recognized, 1 of\nthem "
      "incorrectly. The first is confirmed at frame 0.\n"));
}

TEST_CASE("an operating point from the ground truth is not compared with a chosen one") {
  // The fixed threshold has 7 of 12 correct and the one at 4.5 incorrect; the best possible one has
  // 4 of 12.
  run_ok(scored("--name fixed -o fixed.json --threshold 7"));
  run_ok(scored("--name oracle -o oracle.json"));
  run_ok(scored("--name late -o late.json --threshold 2"));
  const auto compare = [](const std::string& more) {
    return run_ok("vpr-eval compare " + more).out;
  };
  const std::string all = "oracle.json late.json fixed.json ";
  const std::string text = compare(all);
  CHECK(has(text, "oracle: threshold from the ground truth"));
  CHECK(has(text, "  0.6962  0.3333        -          -      -\n"));
  CHECK(has(text, "  0.6962  0.3333        7          1      0\n"));
  CHECK(has(compare(all + "--format markdown"), "| 0.3333 ["));  // equal: none is the best
  CHECK(has(compare(all + "--format markdown"), "| 7 | 1 | 0.5833 |"));
  CHECK_FALSE(has(compare("oracle.json oracle.json -v"), "incorrect"));
}

TEST_CASE("the headline of lists without confidence is the number of correct ones") {
  write_text("pairs.txt", "0 0\n1 1\n2 5\n3 3\n");
  CHECK(run_ok("vpr-eval matrix pairs.txt --ground-truth aligned")
            .out.starts_with("Best match correct in 3 of 4 frames (75.0 %).\n"));
}

TEST_CASE("a result is summed up in 12 lines of 80 columns, with its incorrect ranges") {
  run_ok("vpr-query $db --query $back --c-l 3 --t-r 0.9 -o r.json --quiet");
  write_text("pairs.csv", "query,sequence,reference\n0,one,0\n1,one,1\n2,one,2\n");
  const std::string text = run_ok("vpr-eval r.json --ground-truth pairs.csv").out;
  check_screen(text);
  CHECK(text.starts_with("1 of 3 frames with a match recognized, 1 of them incorrectly;"));
  for (const std::string& part :
       Words{"\n  settings      FastABLE, c_l 3, t_r 0.9 relative\n", ": incorrect",
             "next: compare methods with\n  vpr-tune " + world().database()})
    CHECK(has(text, part));
}

TEST_CASE("the command of the next step repeats the query, or is not given") {
  write_text("pairs.csv", "query,sequence,reference\n0,one,0\n1,one,1\n2,one,2\n");
  write_text("views.csv", "query,reference\n0,1\n");
  const auto next = [](const std::string& query, const std::string& truth) {
    run_ok("vpr-query " + query + " --query $back -o r.json --force --quiet");
    const std::string text = run_ok("vpr-eval r.json --ground-truth " + truth).out;
    return has(text, "next: ") ? text.substr(text.find("next: ")) : "";
  };
  CHECK(has(next("$db --c-l 3 --t-r 0.9 --speed 2", "pairs.csv"), " --speed 2 --seed 1"));
  CHECK(
      next("$fabmap", "views.csv").starts_with("next: compare settings with\n  vpr-tune fabmap "));
  CHECK(next("$db --c-l 3 --t-r 0.9 --only-sequence one", "pairs.csv").empty());
  CHECK(has(run_ok("vpr-query $db --dataset $dataset --query back --force -o r.json").out,
            "next: vpr-eval r.json --dataset " + world().dataset()));
}

TEST_CASE("incorrect recognitions or best matches within a larger tolerance are named") {
  std::vector<float> scores(400, 50);
  for (size_t q = 0; q < 20; ++q) scores[20 * q + (q < 18 ? q : q - 2)] = float(q + 1);
  write_array("s.npy", scores, {20, 20});
  const std::string eval = "vpr-eval matrix s.npy" + kAligned;
  CHECK(run_ok(eval).err ==
        "warning: all 2 incorrect best matches are within 2 frames of the truth. If that is the "
        "same place, use --tolerance 2\n");
  CHECK(run_ok(eval + "--tolerance 2").err.empty());
}

TEST_CASE("a warning about one of several results names it") {
  std::vector<float> train(400);
  std::vector<float> query(400);
  for (size_t i = 0; i < 20; ++i) {
    train[21 * i] = 1;
    query[20 * i + (i < 18 ? i : i - 2)] = 1;
  }
  write_array("train.npy", train, {20, 20});
  write_array("query.npy", query, {20, 20});
  run_ok("vpr-train descriptors --train train.npy -o vectors.vprdb --force");
  const std::string words = "vpr-query vectors.vprdb --query query.npy --c-l 1 --t-r 0.1 --force ";
  run_ok(words + "-o a.json");
  run_ok(words + "-o b.json");
  const std::string by = " --ground-truth aligned ";
  const std::string one = run_ok("vpr-eval a.json" + by).err;
  REQUIRE(one.starts_with("warning: all 2 incorrect"));
  const std::string sentence = one.substr(9);
  CHECK(run_ok("vpr-eval a.json b.json --name first --name second" + by).err ==
        "warning: first: " + sentence + "warning: second: " + sentence);
  CHECK(run_ok("vpr-eval compare a.json b.json" + by).err ==
        "warning: a.json: " + sentence + "warning: b.json: " + sentence);
}

TEST_CASE("a comparison has the name of the query, if any report has it") {
  std::string names;
  for (int i = 0; i < 12; ++i) names += fmt::format("{}.png\n", i);
  write_text("q.txt", names);
  run_ok(scored("-o a.json"));
  run_ok(scored("-o b.json --query q.txt"));
  const auto outcome = run_ok("vpr-eval compare a.json b.json --format latex");
  CHECK(has(outcome.out, "{q: over 12 frames with a match"));
  CHECK(outcome.err.empty());
}

TEST_CASE("positions yield gaps in meters") {
  std::string poses = "frame,x,y\n";
  for (int i = 0; i < 12; ++i) poses += std::to_string(i) + "," + std::to_string(2 * i) + ",0\n";
  write_text("p.csv", poses);
  const Json report = report_of(scored("--poses p.csv"));
  CHECK(report["localization"]["longest_gap_m"] == 16);
  CHECK(report["localization"]["first_recognition_m"] == 0);
}

TEST_CASE("CSV has everything in one row, and -v prints one table each after a short text") {
  const std::string row = run_ok(scored("--format csv")).out;
  CHECK(lines_of(row).size() == 2);
  CHECK(has(row, ",AP,"));
  CHECK(has(row, ",AP of all pairs,"));
  CHECK(has(row, "R@10,"));
  const std::string brief = run_ok(scored()).out;
  CHECK(has(brief, "\n  recall        R@1 0.7500, R@5 0.7500, R@10 0.8333, R@20 1.0000\n"));
  CHECK(has(brief, "\n  ranking       AP 0.6962, R@100P 0.3333\n"));
  check_screen(brief);
  CHECK_FALSE(has(brief, "Recall@K"));
  const std::string text = run_ok(scored("-v")).out;
  CHECK(text.starts_with(brief));
  CHECK(has(text, "Recall@K"));
  CHECK(has(text, "Metrics over 12 frames with a match (0 without an answer"));
}

TEST_CASE("images: a page with the frames of both sequences, and plots") {
  for (const std::string name : {"q", "r"}) write_walk(name, 12, 0);
  const std::string eval = scored("--train r --html e.html --plot plots --query ");
  const auto outcome = run_ok(eval + "q");
  const std::string page = read_text("e.html");
  CHECK(has(page, "s on q"));
  CHECK(has(page, "truth references 9: 09.png"));
  Words plots = {".vpr-files"};
  for (const std::string name :
       {"matrix", "precision-recall", "recall-at", "recall-tolerance", "risk-coverage", "timeline"})
    for (const std::string kind : {".pdf", ".png", ".svg"}) plots.push_back(name + kind);
  CHECK(list_folder("plots") == plots);
  CHECK(outcome.out.starts_with(
      "Best match correct in 9 of 12 frames (75.0 %); 4 frames can be accepted before\n"
      "the first mistake (threshold chosen with the ground truth).\n"));
  CHECK(has(page, "Best match correct in 9 of 12 frames"));
  CHECK_FALSE(has(page, "frames recognized"));
  CHECK(run(eval + "q").exit_code == 2);  // the page exists
  CHECK(run(eval + "q/01.png --force").exit_code != 0);
}

TEST_CASE("reports are compared query by query") {
  std::vector<float> worse(144, 20);
  for (size_t q = 0; q < 6; ++q) worse[13 * q] = float(q + 1);
  write_array("w.npy", worse, {12, 12});
  run_ok(scored("-o s.json --quiet"));
  run_ok("vpr-eval matrix w.npy -o w.json --quiet" + kAligned);
  const std::string compare = "vpr-eval compare s.json w.json";
  const Json found = report_of(compare + " -o c.json");
  CHECK(found["schema"] == "vpr.comparison/5");
  CHECK(found["metrics"][1]["report"] == "w");
  CHECK(found["metrics"][1]["difference"].get<double>() == Approx(-3.0 / 12));
  const std::string text = run_ok(compare).out;
  CHECK(text.starts_with("queries: over 12 frames with a match\nmethod     R@1 "));
  CHECK(has(text, "\nw - s: R@1 -0.2500 (95 %: "));
  CHECK_FALSE(has(text, "Differences to s"));
  CHECK(has(run_ok(compare + " -v").out, "Differences to s over 12 frames with a match"));
  std::fill_n(worse.begin() + 36, 24, std::nanf(""));  // no answer for the query frames 3 and 4
  write_array("w.npy", worse, {12, 12});
  run_ok("vpr-eval matrix w.npy -o w.json --quiet --force" + kAligned);
  CHECK(report_of(compare)["frames"]["compared"] == 12);
  CHECK(report_of(compare + " --common")["frames"]["compared"] == 10);
}

TEST_CASE("damaged reports are refused") {
  const Json good = report_of(scored());
  write_text("good.json", good.dump());
  const auto code = [&](const std::string& key, const Json& value) {
    Json bad = good;
    bad["outcomes"][key] = value;
    write_text("bad.json", bad.dump());
    return run("vpr-eval compare good.json bad.json").exit_code;
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
  write_text("old.json", old.dump());
  CHECK(run("vpr-eval compare good.json old.json").exit_code == 4);
}

TEST_CASE("reports with different ground truths are compared only on request") {
  write_text("g.csv", "query,reference\n0,0\n1,1\n2,3\n11,11\n");
  std::string same = "query,reference\n";
  for (int i = 0; i < 12; ++i) same += std::to_string(i) + "," + std::to_string(i) + "\n";
  write_text("same.csv", same);
  run_ok(scored("-o a.json --quiet"));
  for (const std::string name : {"g", "same"})
    run_ok("vpr-eval matrix s.npy --distance --quiet --ground-truth " + name + ".csv -o " + name +
           ".json");
  check_failure("vpr-eval compare a.json g.json", 4, "--allow-different");
  const auto allowed = run_ok("vpr-eval compare a.json g.json --allow-different -v -o d.json");
  CHECK(has(allowed.out, "\ng: threshold from the ground truth; "));
  const Json found = file_json("d.json");
  CHECK(found["ground_truths"] == "different");
  CHECK(found["frames"]["disputed"] == 8);
  CHECK(found["frames"]["compared"] == 4);
  // The same pairs in another format are equal ground truth.
  CHECK(report_of("vpr-eval compare a.json same.json")["ground_truths"] == "same");
  Json damaged = file_json("g.json");
  damaged["provenance"].erase("ground_truth");
  write_text("damaged.json", damaged.dump());
  const auto unknown = run("vpr-eval compare a.json damaged.json --json");
  CHECK(unknown.exit_code == 4);
  CHECK(has(unknown.err, "\"ground_truth\" is missing"));
}

TEST_CASE("names set by the user stay, and only conflicting automatic names change") {
  run_ok(scored("-o a.json --quiet --name MyNet"));
  for (const std::string file : {"b", "c"}) run_ok(scored("--quiet -o " + file + ".json"));
  const auto names = [&](const std::string& files) {
    Words found;
    const Json compared = report_of("vpr-eval compare " + files);
    for (const Json& report : compared["reports"])
      found.push_back(report["name"].get<std::string>());
    return found;
  };
  CHECK(names("a.json b.json") == Words{"MyNet", "b"});
  CHECK(names("a.json b.json c.json") == Words{"MyNet", "b", "c"});
  CHECK(names("b.json a.json b.json") == Words{"b (1)", "MyNet", "b (3)"});
  CHECK(names("a.json a.json") == Words{"MyNet (1)", "MyNet (2)"});
}

TEST_CASE("single queries are written as rows for data frames") {
  const std::string eval = scored("--name a,b ");
  run_ok(eval + "--outcomes-csv o.csv");
  const std::string text = read_text("o.csv");
  CHECK(text.starts_with(
      "name,query,first_frame,frame,sequence,train_frame,score,outcome,has_match,recognition,rank,"
      "margin\n\"a,b\",queries,0,0,references,0,1,correct,yes,correct,1,\n"));
  CHECK(has(text, "\"a,b\",queries,11,11,references,0,11,incorrect,yes,none,"));
  CHECK(lines_of(text).size() == 13);
  CHECK(run(eval + "--outcomes-csv o.csv").exit_code == 2);  // it exists
}

TEST_CASE("the table of a paper has a row for each method, with the best values in bold") {
  write_report("good", 8);
  write_report("bad", 4);
  const auto table = [&](const std::string& format) {
    const auto outcome = run_ok(
        "vpr-eval compare good.json bad.json --name 'ours & yours' --name theirs --block 1 "
        "--format " +
        format);
    CHECK(outcome.err.empty());
    return outcome.out;
  };
  // 8 of ten positives are correct, and the first 8 accepted ones: AP = R@100P = 0.8, and max F1 =
  // 16 / (8 + 10). R@5 and R@10 count ties of the first rank.
  const std::string text = table("text");
  CHECK(has(text, "ours & yours  0.8000*"));
  CHECK(has(text, "theirs        0.4000 "));
  CHECK_FALSE(has(text, "max F1"));
  CHECK(has(table("latex"), "ours \\& yours & \\textbf{\\shortstack[r]{0.8000\\\\{\\scriptsize ["));
  CHECK(has(table("latex"), "\\label{tab:methods}"));
  CHECK(has(table("markdown"), "| theirs | 0.4000 ["));
  const std::string csv = table("csv");
  CHECK(csv.starts_with("method,query,scores,window,R@1,R@5,R@10,R@20,P@1,"));
  CHECK(has(csv, ",note,R@1 own low,R@1 own high,R@1 difference,R@1 low,R@1 high,R@5 own low,"));
  CHECK(has(csv, "\ntheirs,queries,distance,1,0.4,"));
  CHECK(has(csv, ",-0.4,"));
}

TEST_CASE("several data sets are groups of columns, with a row per method") {
  write_report("good", 8);
  write_report("bad", 4);
  for (const std::string name : {"good", "bad"}) {
    run_ok("vpr-eval matrix " + name + ".npy --query-name wide --data-set broad --name " + name +
           " -o wide-" + name + ".json" + kAligned);
    Json report = file_json(name + ".json");
    report["name"] = name;
    report["data_set"] = "narrow";
    write_text("narrow-" + name + ".json", report.dump());
  }
  Json other = file_json("wide-good.json");  // other labels of its pairs
  other["provenance"]["ground_truth"] = "xxh3:0000000000000000";
  write_text("wide-good.json", other.dump());
  const std::string compare =
      "vpr-eval compare narrow-good.json wide-good.json narrow-bad.json --recall-at 1,7 ";
  const std::string csv = run_ok(compare + "--format csv").out;
  CHECK(csv.starts_with("method,narrow query,"));
  for (const std::string column : {"narrow R@1", "narrow R@7", "broad R@7", "broad AP"})
    CHECK(has(csv, "," + column + ","));
  CHECK_FALSE(has(csv, "R@5"));
  CHECK(has(run_ok(compare + "--format markdown").out, "| method | narrow R@1 | narrow R@7 |"));
  const std::string latex = run_ok(compare + "--format latex").out;
  CHECK(has(latex, "c}{narrow} & \\multicolumn{"));
  CHECK(has(latex, "\\cmidrule(lr){2-"));
  CHECK(has(latex, "\\caption{narrow: Differences to good over 10 frames"));
  CHECK(has(latex, "\nbad & \\shortstack[r]{0.4000\\\\"));
  const std::string text = run_ok(compare).out;
  CHECK(has(text, "\n        narrow"));
  CHECK(has(text, "\nnarrow: bad - good: R@1 -0.4000 (95 %: "));
  CHECK(has(text, "\nbroad: R@1, 95 %, by blocks of "));
  CHECK(report_of(compare + "-o c.json")["schema"] == "vpr.comparisons/5");
  Json best = file_json("narrow-bad.json");  // best matches alone
  best["outcomes"].erase("ranks");
  write_text("best.json", best.dump());
  CHECK(has(run_ok("vpr-eval compare best.json best.json --recall-at 1,7").err,
            "recall@K is unknown for K = 7"));
  run_ok(compare + "--html c.html --plot plots");
  CHECK(has(read_text("c.html"), "<th scope=\"colgroup\" colspan=\""));
  CHECK(list_folder("plots").size() == 13);
}

TEST_CASE("curves and paths of all methods are on one page and in one plot") {
  write_report("<good>", 8);
  write_report("bad", 4);
  run_ok("vpr-eval compare <good>.json bad.json --block 1 --html c.html --plot plots");
  const std::string page = read_text("c.html");
  CHECK(has(page,
            "Best matches of 10 frames with a match are correct in 80.0 % by &lt;good&gt;, 40.0 % "
            "by bad."));
  CHECK(has(page, "<b>0.8000<br><small>["));
  CHECK(has(page, "class=\"line series-1\""));
  CHECK(has(page, "stroke-dasharray:9 4"));  // methods differ without color
  CHECK(page.find("<svg class=\"lanes wide\"") < page.find("<table"));
  CHECK(has(page, "<dt>R@1</dt><dd>-0.4000 ("));  // one row per method after the first
  CHECK_FALSE(has(page, "recall_at_100_precision"));
  CHECK_FALSE(has(page, "http:"));
  CHECK(list_folder("plots") == Words{".vpr-files", "lanes.pdf", "lanes.png", "lanes.svg",
                                      "precision-recall.pdf", "precision-recall.png",
                                      "precision-recall.svg"});
  run_ok(
      "vpr-eval compare <good>.json bad.json --plot small --plot-size 85x60 --plot-limits "
      "0,1,0.3,1");
  const std::string small = read_text("small/precision-recall.svg");
  CHECK(has(small, "width=\"321.26\""));
  CHECK_FALSE(has(small, "2 methods on"));
}

TEST_CASE("a resampled query is compared with the query over its own frames") {
  const auto evaluate = [&](const std::string& name, const std::string& more) {
    run_ok("vpr-query $db --dataset $dataset --c-l 1 --t-r 0.3 -o " + name + ".r.json " + more);
    run_ok("vpr-eval " + name + ".r.json --dataset $dataset -o " + name + ".json --quiet");
  };
  evaluate("plain", "");
  evaluate("slow", "--speed 0.5");
  const Json found = printed_json("vpr-eval compare plain.json slow.json --json");
  CHECK(found["ground_truths"] == "same");
  CHECK(found["reports"][1]["paired"] == false);
  CHECK(found["reports"][1]["selection"] == "at speed 0.5");
  CHECK(found["reports"][1]["frames"] == 2 * found["reports"][0]["frames"].get<int>());
  // Every frame is shown twice: the shares are equal.
  CHECK(found["metrics"][1]["value"] == found["metrics"][0]["value"]);
  CHECK(found["metrics"][1]["difference"] == 0);
  CHECK(found["metrics"][1]["low"].is_null());
  CHECK(has(run_ok("vpr-eval compare plain.json slow.json").out, "of its own"));
  // Equal resampled queries are paired.
  const Json equal = printed_json("vpr-eval compare slow.json slow.json --json");
  CHECK(equal["reports"][1]["paired"] == true);
}
