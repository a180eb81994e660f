// Outputs of vpr-eval for other programs: expectations, XML, trajectories and pages of whole data
// sets.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"
#include "truth/positions.h"

using namespace vpr;
using namespace vpr::test;

namespace {

/// A result of the world's query, with single frames or longer windows.
std::string query(const TemporaryFolder& out, const std::string& name,
                  const std::string& length = "1") {
  run_ok("vpr-query", {world().database(), "--dataset", world().dataset(), "--c-l", length, "--t-r",
                       "0.3", "-o", out / (name + ".json"), "--quiet"});
  return out / (name + ".json");
}

RunOutcome evaluate(const std::string& result, const Words& more) {
  return run_program("vpr-eval", joined({result, "--dataset", world().dataset()}, more));
}

}  // namespace

TEST_CASE("a baseline is written, met, missed and updated") {
  const TemporaryFolder out;
  const std::string result = query(out, "r");
  const std::string baseline = out / "baseline.json";
  check_failure(evaluate(result, {"--expect", baseline}), 3,
                "Create it from this report with --update");
  CHECK(evaluate(result, {"--update"}).exit_code == 2);
  CHECK(evaluate(result, {"--junit", out / "j.xml"}).exit_code == 2);
  ok(evaluate(result, {"--expect", baseline, "--update"}));
  const auto met = ok(evaluate(result, {"--expect", baseline}));
  CHECK(has(met.out, "expected values are met."));
  write_text(baseline, R"({"schema": "vpr.expected/4",
      "best_match": {"rate": {"min": 2}, "frames": {"min": 1}}})");
  const auto missed = evaluate(result, {"--expect", baseline, "--junit", out / "j.xml"});
  CHECK(missed.exit_code == 5);
  CHECK(has(missed.err, "best_match.rate: expected at least 2, found "));
  CHECK(has(read_text(out / "j.xml"), "tests=\"2\" failures=\"1\""));
  const auto updated = ok(evaluate(result, {"--expect", baseline, "--update"}));
  CHECK(has(updated.out, "updated; 1 of 2 expected values were not met."));
  const Json kept = file_json(baseline);
  CHECK(kept["best_match"]["frames"]["min"] == 1);
  CHECK(kept["best_match"]["rate"]["min"].get<double>() <= 1);
  ok(evaluate(result, {"--expect", baseline}));
}

TEST_CASE("recognitions are written as a trajectory of training positions") {
  const TemporaryFolder out;
  const std::string result = query(out, "r");
  ok(evaluate(result, {"--save-trajectory", out / "f.txt", "--outcomes-csv", out / "o.csv"}));
  // For single frames, the closest recognition is the best match, which the rows name.
  const Json dataset = file_json(world().dataset());
  const auto folder = std::filesystem::path(world().dataset()).parent_path();
  std::map<std::string, std::vector<std::optional<RoutePoint>>> routes;
  for (const Json& train : dataset["train"])
    routes[train["name"].get<std::string>()] =
        read_routes({folder / train["poses"].get<std::string>()}).routes.front();
  const double rate = dataset.value("fps", 1.0);
  std::string expected =
      dataset.contains("fps") ? "# time (s) x y z qx qy qz qw\n" : "# time x y z qx qy qz qw\n";
  std::istringstream rows(read_text(out / "o.csv"));
  std::string line;
  std::getline(rows, line);
  while (std::getline(rows, line)) {
    Words cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells[9] == "none") continue;
    const auto& point = routes.at(cells[4]).at(std::stoul(cells[5]));
    REQUIRE(point);
    expected += fmt::format("{:.6f} {:.6f} {:.6f} 0 0 0 0 1\n", std::stod(cells[3]) / rate,
                            point->x, point->y);
  }
  CHECK(read_text(out / "f.txt") == expected);
  CHECK(std::count(expected.begin(), expected.end(), '\n') > 5);
  CHECK(run_program("vpr-eval",
                    {result, "--ground-truth", "aligned", "--save-trajectory", out / "g.txt"})
            .exit_code == 2);
  check_failure("vpr-eval",
                {result, "--ground-truth-train", result, "--pairs", out / "p.txt",
                 "--save-trajectory", out / "g.txt"},
                2, "there is no ground truth");
}

TEST_CASE(
    "recognitions are written from a trajectory with times, at another rate than the frames") {
  const TemporaryFolder out;
  run_ok("vpr-query", {world().database(), "--query", world().walk("one"), "--c-l", "1",
                       "--only-sequence", "one", "--t-r", "0.3", "-o", out / "r.json", "--quiet"});
  // The sequence against itself: one meter per second up a slope, 4 poses and 2 frames per second.
  std::string poses;
  std::string times;
  const Json dataset = file_json(world().dataset());
  const auto folder = std::filesystem::path(world().dataset()).parent_path();
  const auto frames =
      static_cast<int>(read_routes({folder / dataset["train"][0]["poses"].get<std::string>()})
                           .routes.front()
                           .size());
  for (int i = 0; i < 2 * frames; ++i)
    poses += fmt::format("{} {} 0 {} 0 0 0 1\n", 100 + 0.25 * i, 0.25 * i, 0.5 * i);
  std::string expected = "# time (s) x y z qx qy qz qw\n";
  for (int i = 0; i < frames; ++i) {
    times += fmt::format("{}\n", 100 + 0.5 * i);
    const std::string height = i == 0 ? "0" : fmt::format("{:.6f}", 1.0 * i);
    expected += fmt::format("{} {:.6f} 0.000000 {} 0 0 0 1\n", 100 + 0.5 * i, 0.5 * i, height);
  }
  write_text(out / "poses.tum", poses);
  write_text(out / "times.txt", times);
  run_ok("vpr-eval", {out / "r.json", "--ground-truth", out / "poses.tum", "--ground-truth-train",
                      out / "poses.tum", "--radius", "0.1", "--query-times", out / "times.txt",
                      "--train-times", out / "times.txt", "--save-trajectory", out / "f.txt"});
  CHECK(read_text(out / "f.txt") == expected);
  write_text(out / "few.txt", "100\n");
  CHECK(run_program("vpr-eval", {out / "r.json", "--ground-truth", "aligned",
                                 "--ground-truth-train", out / "poses.tum", "--query-times",
                                 out / "few.txt", "--save-trajectory", out / "g.txt"})
            .exit_code != 0);
}

TEST_CASE("a folder of results and reports becomes one table and one page") {
  const TemporaryFolder out;
  std::filesystem::create_directories(out / "all/more");
  const std::string first = query(out, "all/first");
  query(out, "all/more/second", "3");
  ok(evaluate(first, {"-o", out / "all/first.report.json", "--name", "mine"}));
  write_text(out / "all/other.json", R"({"schema": "another"})");
  const Words words = {"report", out / "all", "--dataset", world().dataset()};
  const auto run =
      run_ok("vpr-eval", joined(words, {"--html", out / "all.html", "-o", out / "all.json"}));
  CHECK(has(run.out, ": over "));
  CHECK(has(run.out, "\nmine "));  // a result with a report is listed once
  CHECK(has(run.out, "\nfastable, c_l 3"));
  const Json json = file_json(out / "all.json");
  CHECK(json["schema"] == "vpr.reports/4");
  REQUIRE(json["reports"].size() == 2);
  Json written = file_json(out / "all/first.report.json");
  for (const char* part : {"machine", "timing"}) written.erase(part);
  CHECK(json["reports"][0]["report"].dump() == written.dump());  // as it was read
  const std::string page = read_text(out / "all.html");
  CHECK(has(page, "2 methods on 1 query"));
  CHECK(page.find("<svg class=\"lanes wide\"") < page.find("recognized correctly"));
  CHECK_FALSE(has(page, "All queries"));  // there is one
  const std::string csv = run_program("vpr-eval", joined(words, {"--format", "csv"})).out;
  CHECK(csv.starts_with("method,query,metric,value,frames,oracle\n"));
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 2 * 5);
  // Without ground truth, only reports.
  const auto alone = run_ok("vpr-eval", {"report", out / "all"});
  CHECK_FALSE(has(alone.out, "c_l 3"));
  CHECK(run_program("vpr-eval", {"report", out / "none"}).exit_code == 3);
  CHECK(run_program("vpr-eval", {"report", out / "all/more"}).exit_code == 3);
  std::filesystem::copy(out / "all/first.report.json", out / "all/again.json");
  check_failure("vpr-eval", {"report", out / "all"}, 2, "are both of mine on");
}

TEST_CASE("a method that answers few frames does not win by them") {
  const TemporaryFolder out;
  std::filesystem::create_directory(out / "all");
  // Ten frames: windows of 5 end at 6 frames and are all correct; single frames are correct in 9 of
  // 10.
  const auto report = [&](const std::string& name, size_t size, size_t mistakes,
                          const std::string& window) {
    std::vector<float> scores(size * size, 50);
    for (size_t q = 0; q < size; ++q) scores[q * size + (q < mistakes ? size - 1 : q)] = float(q);
    write_array(out / (name + ".npy"), scores, {size, size});
    run_ok("vpr-eval", {"matrix", out / (name + ".npy"), "--distance", "--rows-are-windows-of",
                        window, "--ground-truth", "aligned", "--name", name, "-o",
                        out / ("all/" + name + ".json"), "--quiet"});
  };
  report("frames", 10, 1, "1");
  report("windows", 6, 0, "5");
  const Json json =
      printed_json("vpr-eval", {"report", out / "all", "--html", out / "all.html", "--json"});
  CHECK(json["reports"][1]["report"]["metrics"]["recall_at"]["1"] == 0.6);
  CHECK(json["reports"][1]["report"]["localization"]["frames_with_match"] == 10);
  const std::string brief = run_program("vpr-eval", {"report", out / "all"}).out;
  CHECK(brief.starts_with("queries: over 10 frames with a match\n"));
  CHECK(has(brief, "\nframes   0.9000*"));
  CHECK(has(brief, "\nwindows  0.6000 "));
  const std::string text = run_program("vpr-eval", {"report", out / "all", "-v"}).out;
  CHECK(text.starts_with(brief));
  CHECK(has(text, "frames   0.9000 (9 of 10)*"));
  CHECK(has(text, "windows  0.6000 (6 of 10)\n"));
  CHECK(has(text, "over all frames with a match"));
  CHECK(has(text, "0.6000 (6 of 10, oracle)"));
  CHECK(has(read_text(out / "all.html"), "correct: frames, R@1 0.9000 (9 of 10)."));
}

TEST_CASE("results of several window lengths are shown over the same frames") {
  const TemporaryFolder out;
  const auto run = run_ok("vpr-eval", {query(out, "one"), query(out, "two", "9"), "--dataset",
                                       world().dataset(), "--format", "csv"});
  Words of_frames;
  std::istringstream rows(run.out);
  std::string line;
  std::getline(rows, line);
  Words columns;
  std::istringstream head(line);
  for (std::string cell; std::getline(head, cell, ',');) columns.push_back(cell);
  const auto at = std::find(columns.begin(), columns.end(), "of frames") - columns.begin();
  while (std::getline(rows, line)) {
    std::istringstream row(line);
    std::string cell;
    for (ptrdiff_t i = 0; i <= at; ++i) std::getline(row, cell, ',');
    of_frames.push_back(cell);
  }
  REQUIRE(of_frames.size() == 2);
  CHECK(of_frames[0] == of_frames[1]);
}

TEST_CASE("results without ground truth, and pages of several reports, are refused with advice") {
  const TemporaryFolder out;
  const std::string result = query(out, "r");
  check_failure("vpr-eval", {"compare", result, result}, 2, "Add --ground-truth or --dataset");
  check_failure("vpr-eval", {result, result, "--ground-truth", "aligned", "--html", out / "p.html"},
                2, "vpr-eval report FOLDER --html");
}

TEST_CASE("a folder's table never replaces its reports and results") {
  const TemporaryFolder out;
  std::filesystem::create_directories(out / "all");
  const std::string result = query(out, "all/first");
  ok(evaluate(result, {"-o", out / "all/report.json"}));
  const auto write = [&](const std::string& name) {
    return run_program("vpr-eval", {"report", out / "all", "-o", out / name, "--force"});
  };
  for (const char* name : {"all/report.json", "all/first.json", "all/first.recognitions.npy"}) {
    const std::string before = read_text(out / name);
    check_failure(write(name), 2, "is an input of this run");
    CHECK(read_text(out / name) == before);
  }
  ok(write("all/table.json"));
  ok(write("all/table.json"));  // an earlier table is not an input
}
