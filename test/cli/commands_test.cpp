// The programs as a user runs them, on a small generated world.
#include <algorithm>
#include <sstream>

#include <catch2/catch.hpp>

#include "base/json.h"
#include "base/npy.h"
#include "base/simd.h"
#include "cli/world.h"
#include "support.h"

using namespace vpr;
using test::check_failure;
using test::run_program;
using test::world;
namespace fs = std::filesystem;

namespace {

std::vector<std::string> query_words(std::vector<std::string> more = {}) {
  std::vector<std::string> words = {world().database(), "--dataset", world().dataset(), "--c-l",
                                    "10"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Json parse(const std::string& text) { return Json::parse(text); }

// A result without what may differ between runs.
std::string comparable(const fs::path& path) {
  Json json = parse(test::read_text(path));
  json.erase("machine");
  json.erase("timing");
  return json.dump(2);
}

}  // namespace

TEST_CASE("train, query and evaluate give counts that are right") {
  const test::TemporaryFolder out;
  const auto query =
      run_program("vpr-query", query_words({"-o", out / "r.json", "--verify", "500"}));
  CHECK(query.exit_code == 0);
  CHECK(query.out.find("500 cells, 0 differences") != std::string::npos);
  // Corridors that look alike lower the automatic t_r.
  CHECK(query.err.starts_with("warning: one and two seem to show the same place"));
  const auto eval = run_program(
      "vpr-eval", {out / "r.json", "--dataset", world().dataset(), "-o", out / "e.json", "--json"});
  REQUIRE(eval.exit_code == 0);
  const Json report = parse(eval.out);
  CHECK(report == parse(test::read_text(out / "e.json")));
  CHECK(report["counts"]["hits"]["correct"].get<int>() > 20);
  CHECK(report["counts"]["hits"]["incorrect"] == 0);
  CHECK(report["counts"]["distinct"].get<int>() >= 1);
  CHECK(report["best_match"]["rate"].get<double>() > 0.8);
}

TEST_CASE("results are byte-identical for any threads, SIMD target and method") {
  const test::TemporaryFolder out;
  run_program("vpr-query", query_words({"-o", out / "a.json", "--threads", "1"}));
  const std::string expected = comparable(out / "a.json");
  const std::string hits = test::read_text(out / "a.hits.npy");
  for (const std::string& target : simd_targets()) {
    const std::string name = "r" + target;
    CHECK(run_program("vpr-query", query_words({"-o", out / (name + ".json"), "--threads", "2"}),
                      {"VPR_SIMD=" + target})
              .exit_code == 0);
    CHECK(comparable(out / (name + ".json")) == expected);
    CHECK(test::read_text(out / (name + ".hits.npy")) == hits);
  }
  for (const std::string method : {"openable", "fastable-online"}) {
    run_program("vpr-query", query_words({"-o", out / (method + ".json"), "--method", method,
                                          "--max-memory", "1M"}));
    CHECK(test::read_text(out / (method + ".hits.npy")) == hits);
  }
}

TEST_CASE("databases are byte-identical for any number of threads, and name no path or host") {
  const test::TemporaryFolder out;
  CHECK(run_program("vpr-train", {"fastable", "--dataset", world().dataset(), "--c-l", "10", "-o",
                                  out / "b.vprdb", "--threads", "1"})
            .exit_code == 0);
  for (const char* name : {"manifest.json", "codes.npy", "frames.txt"})
    CHECK(test::read_text(out / "b.vprdb" / name) ==
          test::read_text(fs::path(world().database()) / name));
  CHECK(test::read_text(out / "b.vprdb/manifest.json").find("/tmp") == std::string::npos);
}

TEST_CASE("a rendered world is byte-identical for its seed and any number of threads") {
  const test::TemporaryFolder out;
  run_program("vpr-synth", {world().folder() / "world.json", "-o", out / "w", "--threads", "1"});
  for (const auto& entry : fs::recursive_directory_iterator(out / "w"))
    if (entry.is_regular_file())
      REQUIRE(test::read_text(entry.path()) ==
              test::read_text(world().folder() / "walk" / fs::relative(entry.path(), out / "w")));
}

TEST_CASE("adding a sequence gives the database of training them together") {
  const test::TemporaryFolder out;
  const std::string one = world().walk("one");
  const std::string two = world().walk("two");
  run_program("vpr-train", {"fastable", "--train", one, "--c-l", "10", "-o", out / "a.vprdb"});
  CHECK(run_program("vpr-train", {"add", out / "a.vprdb", "--train", two, "-o", out / "ab.vprdb"})
            .exit_code == 0);
  run_program("vpr-train", {"fastable", "--train", one, "--train", two, "--c-l", "10", "-o",
                            out / "both.vprdb"});
  CHECK(test::read_text(out / "ab.vprdb/manifest.json") ==
        test::read_text(out / "both.vprdb/manifest.json"));
  const auto info = run_program("vpr-train", {"info", out / "ab.vprdb", "--json"});
  CHECK(parse(info.out)["sequences"][1]["name"] == "two");
  CHECK(parse(info.out)["descriptor"] == "ldb");
  const auto again = run_program(
      "vpr-train", {"add", out / "a.vprdb", "--train", one, "-o", out / "x.vprdb", "--json"});
  CHECK(parse(again.out)["sequences"][1]["name"] == "walk/one");
}

TEST_CASE("each sub-folder is a training sequence with --train-folders") {
  const test::TemporaryFolder out;
  const auto run =
      run_program("vpr-train", {"fastable", "--train-folders", world().folder() / "walk", "--c-l",
                                "10", "-o", out / "all.vprdb", "--json"});
  REQUIRE(run.exit_code == 0);
  CHECK(parse(run.out)["sequences"].size() == 5);
}

TEST_CASE("a saved matrix holds every distance; a picture can be drawn") {
  const test::TemporaryFolder out;
  REQUIRE(
      run_program("vpr-query", query_words({"-o", out / "r.json", "--save-matrix", out / "d.npy"}))
          .exit_code == 0);
  const Json result = parse(test::read_text(out / "r.json"));
  const NpyArray matrix(out / "d.npy");
  const auto values = matrix.values<int32_t>(2);
  CHECK(matrix.shape()[0] == result["query"]["windows"]);
  CHECK(matrix.shape()[1] == result["matrix"]["columns"]);
  const NpyArray hits(out / "r.hits.npy");
  const auto cells = hits.values<int32_t>(2);
  const NpyArray hit_scores(out / "r.hit_scores.npy");
  const auto scores = hit_scores.values<double>(1);
  const auto second = result["matrix"]["sequences"][1]["first_column"].get<int>();
  size_t below = 0;
  for (const auto& v : values) {
    REQUIRE(v >= 0);
    REQUIRE(v <= 13860);
  }
  for (size_t i = 0; i < hits.shape()[0]; ++i, ++below)
    REQUIRE(values[size_t(cells[3 * i]) * matrix.shape()[1] +
                   size_t(cells[3 * i + 1] == 0 ? 0 : second) + size_t(cells[3 * i + 2])] ==
            scores[i]);
  CHECK(below > 0);
  CHECK(
      run_program("vpr-query", query_words({"-o", out / "p.json", "--save-matrix", out / "d.png"}))
          .exit_code == 0);
  CHECK(test::read_text(out / "d.png").substr(1, 3) == "PNG");
}

TEST_CASE("unreadable frames, if skipped, break windows and are -1 in a matrix") {
  const test::TemporaryFolder out;
  fs::copy(world().walk("back"), out / "back");
  test::write_text(out / "back/00020.png", "broken");
  const std::vector<std::string> base = {
      world().database(), "--query", out / "back", "--c-l", "10", "-o", out / "r.json"};
  const auto refused = run_program("vpr-query", base);
  CHECK(refused.exit_code == 3);
  CHECK(refused.err.find("00020.png") != std::string::npos);
  auto words = base;
  words.insert(words.end(),
               {"--skip-unreadable", "--save-matrix", out / "d.npy", "--verify", "99"});
  REQUIRE(run_program("vpr-query", words).exit_code == 0);
  const NpyArray best(out / "r.best.npy");
  const auto rows = best.values<int32_t>(2);
  const NpyArray matrix(out / "d.npy");
  const auto values = matrix.values<int32_t>(2);
  for (size_t window = 0; window < best.shape()[0]; ++window) {
    const bool broken = window >= 11 && window <= 20;
    REQUIRE((rows[3 * window + 1] == -1) == broken);
    REQUIRE((values[window * matrix.shape()[1]] == -1) == broken);
  }
}

TEST_CASE("a search can be limited to a sequence by name") {
  const test::TemporaryFolder out;
  REQUIRE(run_program("vpr-query", query_words({"--only-sequence", "two", "-o", out / "r.json"}))
              .exit_code == 0);
  const Json result = parse(test::read_text(out / "r.json"));
  CHECK(result["targets"][0]["searched"] == false);
  const auto wrong = run_program("vpr-query", query_words({"--only-sequence", "three", "--json"}));
  CHECK(wrong.exit_code == 2);
  CHECK(wrong.err.find("one, two") != std::string::npos);
}

TEST_CASE("settings come from a file, and flags win") {
  const test::TemporaryFolder out;
  test::write_text(out / "c.json", R"({"schema": "vpr.config/1", "c_l": 5, "t_r": 0.3, "seed": 9,
                                       "clustering": {"eps": 3}})");
  const std::vector<std::string> base = {world().database(), "--dataset",    world().dataset(),
                                         "--config",         out / "c.json", "--json"};
  const Json from_file = parse(run_program("vpr-query", base).out);
  CHECK(from_file["settings"]["c_l"] == 5);
  CHECK(from_file["settings"]["t_r"] == 0.3);
  CHECK(from_file["settings"]["clustering"]["eps"] == 3);
  CHECK(from_file["provenance"]["seed"] == 9);
  auto words = base;
  words.insert(words.begin(), {"--t-r", "0.5"});
  CHECK(parse(run_program("vpr-query", words).out)["settings"]["t_r"] == 0.5);
  test::write_text(out / "c.json", R"({"t_l": 5})");
  const auto wrong = run_program("vpr-query", base);
  CHECK(wrong.exit_code == 2);
  CHECK(wrong.err.find("did you mean") != std::string::npos);
}

TEST_CASE("a result stands for the settings it was made with") {
  const test::TemporaryFolder out;
  const std::vector<std::vector<std::string>> all = {
      {"--t-r", "0.6", "--seed", "7"}, {}, {"--score", "standardized", "--t-r", "-1"}};
  for (const auto& settings : all) {
    std::vector<std::string> words = settings;
    words.insert(words.end(), {"-o", out / "r.json", "--force"});
    REQUIRE(run_program("vpr-query", query_words(words)).exit_code == 0);
    const Json first = parse(test::read_text(out / "r.json"));
    const auto again = run_program("vpr-query", {world().database(), "--dataset", world().dataset(),
                                                 "--config", out / "r.json", "--json"});
    INFO(again.err);
    REQUIRE(again.exit_code == 0);
    const Json second = parse(again.out);
    CHECK(second["settings"] == first["settings"]);
    CHECK(second["provenance"]["seed"] == first["provenance"]["seed"]);
    CHECK(second["totals"] == first["totals"]);
  }
  std::string damaged = test::read_text(out / "r.json");
  damaged.replace(damaged.find("\"c_l\": 10"), 9, "\"c_l\": 11");
  test::write_text(out / "d.json", damaged);
  CHECK(run_program("vpr-query", query_words({"--config", out / "d.json"})).exit_code == 4);
}

TEST_CASE("a key for another kind of database is refused, as its flag is") {
  const test::TemporaryFolder out;
  test::write_text(out / "c.json", R"({"c_l": 5, "t_p": 0.3})");
  const auto refused = run_program("vpr-query", {world().database(), "--dataset", world().dataset(),
                                                 "--config", out / "c.json"});
  CHECK(refused.exit_code == 2);
  CHECK(refused.err.find("t_p has no effect with a database for fastable") != std::string::npos);
}

TEST_CASE("a database and a query are enough for an answer") {
  const test::TemporaryFolder out;
  const auto query = run_program("vpr-query", query_words());
  CHECK(query.exit_code == 0);
  CHECK(query.out.find("windows recognised") != std::string::npos);
  CHECK(query.out.find("\none") != std::string::npos);  // a place in the sequence "one"
  REQUIRE(run_program("vpr-train", {"fastable", "--train", world().walk("one"), "--c-l", "10", "-o",
                                    out / "one.vprdb"})
              .exit_code == 0);
  const std::vector<std::string> words = {out / "one.vprdb", "--query", world().walk("back"),
                                          "--c-l", "10"};
  check_failure(run_program("vpr-query", words), 2,
                "the automatic t_r needs two or more training sequences. Use --method filter, "
                "--score standardized --decide margin, or a number, as in --t-r 0.6.");
  auto by_margin = words;
  by_margin.insert(by_margin.end(), {"--score", "standardized", "--decide", "margin"});
  const auto single = run_program("vpr-query", by_margin);
  INFO(single.out << single.err);
  CHECK(single.exit_code == 0);
  CHECK(single.out.find("\none") != std::string::npos);
  check_failure(run_program("vpr-tune", {"threshold", out / "one.vprdb"}), 2,
                "two or more training sequences");
}

TEST_CASE("where nothing or everything is recognized, no looser threshold is suggested") {
  for (const std::vector<std::string>& strict :
       {std::vector<std::string>{"--t-r", "0.01"},
        {"--score", "standardized", "--t-r", "-20"},
        {"--score", "standardized", "--decide", "margin", "--margin", "60"}}) {
    const auto none = run_program("vpr-query", query_words(strict));
    INFO(none.out);
    CHECK(none.exit_code == 0);
    CHECK(none.out.find(" frames: use --method filter.\n") != std::string::npos);
    CHECK(none.out.find("--t-r ") == std::string::npos);
    CHECK(none.out.find("--margin ") == std::string::npos);
  }
  const auto other = run_program("vpr-query", {world().database(), "--query", world().walk("other"),
                                               "--c-l", "10", "--t-r", "0.01"});
  INFO(other.out);
  CHECK(other.out.find("may show another place or the opposite direction") != std::string::npos);
  CHECK(other.out.find("use --method filter") == std::string::npos);
  const auto all = run_program("vpr-query", query_words({"--t-r", "1"}));
  CHECK(all.err.find("% of all window pairs are hits: t_r is too large") != std::string::npos);
  CHECK(all.out.find("vpr-query") == std::string::npos);
}

TEST_CASE("an expectation that is not met ends with 5 and a readable difference") {
  const test::TemporaryFolder out;
  run_program("vpr-query", query_words({"-o", out / "r.json"}));
  const std::vector<std::string> base = {out / "r.json", "--dataset", world().dataset()};
  auto first = base;
  first.insert(first.end(), {"-o", out / "e.json"});
  run_program("vpr-eval", first);
  auto same = base;
  same.insert(same.end(), {"--expect", out / "e.json"});
  CHECK(run_program("vpr-eval", same).exit_code == 0);
  test::write_text(out / "x.json",
                   R"({"schema": "vpr.expected/1", "counts": {"hits": {"incorrect": 1}}})");
  auto other = base;
  other.insert(other.end(), {"--expect", out / "x.json"});
  const auto failed = run_program("vpr-eval", other);
  CHECK(failed.exit_code == 5);
  CHECK(failed.err.find("counts.hits.incorrect: expected 1, found 0 (-1)") != std::string::npos);
}

TEST_CASE("tables come as text, CSV, Markdown and LaTeX") {
  const test::TemporaryFolder out;
  run_program("vpr-query", query_words({"-o", out / "r.json"}));
  const auto table = [&](const std::string& format) {
    return run_program("vpr-eval",
                       {out / "r.json", "--dataset", world().dataset(), "--format", format})
        .out;
  };
  CHECK(table("text").find("c_l") != std::string::npos);
  CHECK(table("csv").find("name,method,query,c_l,t_r,scale,hits right,hits wrong,") == 0);
  CHECK(table("markdown").find("| c_l |") != std::string::npos);
  CHECK(table("latex").find("\\begin{tabular}") != std::string::npos);
}

TEST_CASE("a result can be looked at without a ground truth, and nothing else") {
  const test::TemporaryFolder out;
  REQUIRE(run_program("vpr-query", query_words({"-o", out / "r.json"})).exit_code == 0);
  const auto eval = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {out / "r.json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program("vpr-eval", words);
  };
  const auto looked = eval({"--html", out / "page.html", "--query", world().walk("back")});
  CHECK(looked.exit_code == 0);
  CHECK(looked.err.empty());
  CHECK(looked.out.find("Nothing is judged without a ground truth.") != std::string::npos);
  CHECK(looked.out.find("hits") != std::string::npos);
  CHECK(looked.out.find("right") == std::string::npos);
  const std::string page = test::read_text(out / "page.html");
  CHECK(page.find("recognised, not judged") != std::string::npos);
  CHECK(page.find("data:image/jpeg") != std::string::npos);
  const auto alone = eval({});
  CHECK(alone.exit_code == 2);
  CHECK(alone.err.find("--html") != std::string::npos);
  for (const std::string flag : {"-o", "--expect"})
    CHECK(eval({"--html", out / "other.html", flag, out / "r.json"}).exit_code == 2);
  CHECK(eval({"--html", out / "other.html", "--json"}).exit_code == 2);
  CHECK_FALSE(fs::exists(out / "other.html"));
  test::write_text(out / "bare.json",
                   Json{{"schema", "vpr.dataset/1"},
                        {"name", "bare"},
                        {"fps", 4},
                        {"queries", {{{"name", "back"}, {"sequence", world().walk("back")}}}}}
                       .dump());
  const auto timed = eval({"--html", out / "bare.html", "--dataset", out / "bare.json"});
  CHECK(timed.err.empty());
  CHECK(timed.out.find(" s). Nothing is judged") != std::string::npos);
}

TEST_CASE("every program has help with an example, and a version") {
  for (const std::string program :
       {"vpr-train", "vpr-query", "vpr-eval", "vpr-tune", "vpr-bench", "vpr-synth"}) {
    const auto help = run_program(program, {"--help"});
    CHECK(help.exit_code == 0);
    CHECK(help.out.find("Example:") != std::string::npos);
    CHECK(run_program(program, {"--version"}).out.find(program) == 0);
  }
  CHECK(run_program("vpr-train", {"fastable", "--help"}).out.find("Example:") != std::string::npos);
}

TEST_CASE("a map shows one result or two of the same query, as SVG and PNG") {
  const test::TemporaryFolder out;
  for (const char* name : {"a", "b"})
    REQUIRE(
        run_program("vpr-query", query_words({"-o", (out / name).string() + ".json"})).exit_code ==
        0);
  const auto eval = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {out / "a.json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program("vpr-eval", words);
  };
  CHECK(eval({"--map", out / "m"}).exit_code == 2);  // without a data set
  fs::copy(world().folder() / "walk", out / "walk", fs::copy_options::recursive);
  test::write_text(out / "walk/back/poses.csv", "frame,x,y\n");
  CHECK(eval({"--dataset", out / "walk/two_walks.json", "--map", out / "m"}).exit_code == 4);
  CHECK(eval({"--dataset", world().dataset(), "--map-with", out / "b.json"}).exit_code == 2);
  const auto drawn =
      eval({"--dataset", world().dataset(), "--map", out / "m", "--map-with", out / "b.json"});
  CHECK(drawn.exit_code == 0);
  CHECK(test::list_folder(out / "m") ==
        std::vector<std::string>{".vpr-files", "map.png", "map.svg"});
  CHECK(test::read_text(out / "m/map.svg").find("recognised, wrong") == std::string::npos);
  CHECK(test::read_text(out / "m/map.svg").find("recognised, right") != std::string::npos);
}
