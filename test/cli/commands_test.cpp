// The programs on a small generated world.
#include <catch2/catch.hpp>

#include "cli/building.h"
#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

Words query_words(Words more = {}) {
  return joined({world().database(), "--dataset", world().dataset(), "--c-l", "10"}, more);
}

// A result without the parts that may differ between runs.
std::string comparable(const fs::path& path) {
  Json json = file_json(path);
  json.erase("machine");
  json.erase("timing");
  return json.dump(2);
}

}  // namespace

TEST_CASE("train, query and evaluate yield correct counts") {
  const TemporaryFolder out;
  const auto query = run_ok("vpr-query", query_words({"-o", out / "r.json", "--verify", "500"}));
  CHECK(has(query.out, "500 cells, 0 differences"));
  // Similar corridors lower the automatic t_r.
  CHECK(query.err.starts_with("warning: one and two seem to show the same place"));
  const Json report = printed_json(
      "vpr-eval", {out / "r.json", "--dataset", world().dataset(), "-o", out / "e.json", "--json"});
  CHECK(report == file_json(out / "e.json"));
  CHECK(report["counts"]["pairs"]["correct"].get<int>() > 20);
  CHECK(report["counts"]["pairs"]["incorrect"] == 0);
  CHECK(report["counts"]["pairs_by_place"]["correct"].get<int>() > 20);
  CHECK(report["counts"]["distinct"].get<int>() >= 1);
  CHECK(report["best_match"]["rate"].get<double>() > 0.7);
}

TEST_CASE("results are byte-identical for any threads, SIMD target and method") {
  const TemporaryFolder out;
  run_program("vpr-query", query_words({"-o", out / "a.json", "--threads", "1"}));
  const std::string expected = comparable(out / "a.json");
  const std::string recognitions = read_text(out / "a.recognitions.npy");
  for (const std::string& target : simd_targets()) {
    const std::string name = "r" + target;
    run_ok("vpr-query", query_words({"-o", out / (name + ".json"), "--threads", "2"}),
           {"VPR_SIMD=" + target});
    CHECK(comparable(out / (name + ".json")) == expected);
    CHECK(read_text(out / (name + ".recognitions.npy")) == recognitions);
  }
  for (const std::string method : {"openable", "fastable-online"}) {
    run_program("vpr-query", query_words({"-o", out / (method + ".json"), "--method", method,
                                          "--max-memory", "1M"}));
    CHECK(read_text(out / (method + ".recognitions.npy")) == recognitions);
  }
}

TEST_CASE("databases are byte-identical for any number of threads, and name no path or host") {
  const TemporaryFolder out;
  run_ok("vpr-train", {"fastable", "--dataset", world().dataset(), "--c-l", "10", "-o",
                       out / "b.vprdb", "--threads", "1"});
  for (const char* name : {"manifest.json", "codes.npy", "frames.txt"})
    CHECK(read_text(out / "b.vprdb" / name) == read_text(fs::path(world().database()) / name));
  CHECK_FALSE(has(read_text(out / "b.vprdb/manifest.json"), "/tmp"));
}

TEST_CASE("a rendered world is byte-identical for its seed and any number of threads") {
  const TemporaryFolder out;
  run_program("vpr-synth", {world().folder() / "world.json", "-o", out / "w", "--threads", "1"});
  for (const auto& entry : fs::recursive_directory_iterator(out / "w"))
    if (entry.is_regular_file())
      REQUIRE(read_text(entry.path()) ==
              read_text(world().folder() / "walk" / fs::relative(entry.path(), out / "w")));
}

TEST_CASE("adding a sequence yields the database of training both together") {
  const TemporaryFolder out;
  const std::string one = world().walk("one");
  const std::string two = world().walk("two");
  run_program("vpr-train", {"fastable", "--train", one, "--c-l", "10", "-o", out / "a.vprdb"});
  run_ok("vpr-train", {"add", out / "a.vprdb", "--train", two, "-o", out / "ab.vprdb"});
  run_program("vpr-train", {"fastable", "--train", one, "--train", two, "--c-l", "10", "-o",
                            out / "both.vprdb"});
  CHECK(read_text(out / "ab.vprdb/manifest.json") == read_text(out / "both.vprdb/manifest.json"));
  const Json info = printed_json("vpr-train", {"info", out / "ab.vprdb", "--json"});
  CHECK(info["sequences"][1]["name"] == "two");
  CHECK(info["descriptor"] == "ldb");
  CHECK(printed_json("vpr-train", {"add", out / "a.vprdb", "--train", one, "-o", out / "x.vprdb",
                                   "--json"})["sequences"][1]["name"] == "walk/one");
}

TEST_CASE("each subfolder is a training sequence with --train-folders") {
  const TemporaryFolder out;
  CHECK(printed_json("vpr-train", {"fastable", "--train-folders", world().folder() / "walk",
                                   "--c-l", "10", "-o", out / "all.vprdb", "--json"})["sequences"]
            .size() == 5);
}

TEST_CASE("a saved matrix holds every distance and can be drawn") {
  const TemporaryFolder out;
  run_ok("vpr-query", query_words({"-o", out / "r.json", "--save-matrix", out / "d.npy"}));
  const Json result = file_json(out / "r.json");
  const NpyArray matrix(out / "d.npy");
  const auto values = matrix.values<int32_t>(2);
  CHECK(matrix.shape()[0] == result["query"]["windows"]);
  CHECK(matrix.shape()[1] == result["matrix"]["columns"]);
  const NpyArray recognitions(out / "r.recognitions.npy");
  const auto cells = recognitions.values<int32_t>(2);
  const auto scores = read_array<double>(out / "r.recognition_scores.npy");
  const auto second = result["matrix"]["sequences"][1]["first_column"].get<int>();
  for (const auto& v : values) REQUIRE((v >= 0 && v <= 13860));
  for (size_t i = 0; i < recognitions.shape()[0]; ++i)
    REQUIRE(values[size_t(cells[3 * i]) * matrix.shape()[1] +
                   size_t(cells[3 * i + 1] == 0 ? 0 : second) + size_t(cells[3 * i + 2])] ==
            scores[i]);
  CHECK(recognitions.shape()[0] > 0);
  run_ok("vpr-query", query_words({"-o", out / "p.json", "--save-matrix", out / "d.png"}));
  CHECK(read_text(out / "d.png").substr(1, 3) == "PNG");
}

TEST_CASE("skipped unreadable frames split windows and are -1 in a matrix") {
  const TemporaryFolder out;
  fs::copy(world().walk("back"), out / "back");
  write_text(out / "back/00020.png", "broken");
  const Words base = {world().database(), "--query", out / "back", "--c-l", "10", "-o",
                      out / "r.json"};
  check_failure("vpr-query", base, 3, "00020.png");
  run_ok("vpr-query",
         joined(base, {"--skip-unreadable", "--save-matrix", out / "d.npy", "--verify", "99"}));
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
  const TemporaryFolder out;
  run_ok("vpr-query", query_words({"--only-sequence", "two", "-o", out / "r.json"}));
  const Json result = file_json(out / "r.json");
  CHECK(result["sequences"][0]["searched"] == false);
  check_failure("vpr-query", query_words({"--only-sequence", "three", "--json"}), 2, "one, two");
}

TEST_CASE("settings are read from a file, and flags take precedence") {
  const TemporaryFolder out;
  write_text(out / "c.json", R"({"schema": "vpr.config/3", "c_l": 5, "t_r": 0.3, "seed": 9,
                                       "clustering": {"eps": 3}})");
  const Words base = {world().database(), "--dataset", world().dataset(),
                      "--json",           "--config",  out / "c.json"};
  const Json from_file = printed_json("vpr-query", base);
  CHECK(from_file["settings"]["c_l"] == 5);
  CHECK(from_file["settings"]["t_r"] == 0.3);
  CHECK(from_file["settings"]["clustering"]["eps"] == 3);
  CHECK(from_file["provenance"]["seed"] == 9);
  CHECK(printed_json("vpr-query", joined(base, {"--t-r", "0.5"}))["settings"]["t_r"] == 0.5);
  write_text(out / "c.json", R"({"t_l": 5})");
  check_failure("vpr-query", base, 2, "did you mean");
}

TEST_CASE("a result can be used as its own settings") {
  const TemporaryFolder out;
  const std::vector<Words> all = {
      {"--t-r", "0.6", "--seed", "7"}, {}, {"--score", "zscore", "--t-r", "-1"}};
  for (const auto& settings : all) {
    run_ok("vpr-query", query_words(joined(settings, {"-o", out / "r.json", "--force"})));
    const Json first = file_json(out / "r.json");
    const Json second = printed_json(
        "vpr-query",
        {world().database(), "--dataset", world().dataset(), "--config", out / "r.json", "--json"});
    CHECK(second["settings"] == first["settings"]);
    CHECK(second["provenance"]["seed"] == first["provenance"]["seed"]);
    CHECK(second["totals"] == first["totals"]);
  }
  std::string damaged = read_text(out / "r.json");
  damaged.replace(damaged.find("\"c_l\": 10"), 9, "\"c_l\": 11");
  write_text(out / "d.json", damaged);
  CHECK(run_program("vpr-query", query_words({"--config", out / "d.json"})).exit_code == 4);
}

TEST_CASE("a world is rendered with the seed of a configuration file") {
  const TemporaryFolder out;
  write_text(out / "c.json", R"({"seed": 9})");
  for (const uint64_t seed : {1, 9}) {
    Json json = Json::parse(building(seed, {"one"}));
    json["walks"][0]["frames"] = 2;
    write_text(out / "world.json", json.dump());
    run_ok("vpr-synth", joined({out / "world.json", "-o", out / std::to_string(seed)},
                               seed == 1 ? Words{"--config", out / "c.json"} : Words{}));
  }
  CHECK(read_text(out / "1/one/poses.csv") == read_text(out / "9/one/poses.csv"));
}

TEST_CASE("a key for another kind of database is refused, like its flag") {
  const TemporaryFolder out;
  write_text(out / "c.json", R"({"c_l": 5, "t_p": 0.3})");
  check_failure("vpr-query",
                {world().database(), "--dataset", world().dataset(), "--config", out / "c.json"}, 2,
                "t_p has no effect with a database for fastable");
}

TEST_CASE("a database and a query are sufficient") {
  const TemporaryFolder out;
  const auto query = run_ok("vpr-query", query_words());
  CHECK(query.out.starts_with("Recognized "));
  CHECK(has(query.out, " = one "));  // a range of the sequence "one"
  CHECK(has(query.out, "\nSettings: fastable, c_l 10, raw, t_r "));
  run_ok("vpr-train",
         {"fastable", "--train", world().walk("one"), "--c-l", "10", "-o", out / "one.vprdb"});
  const Words words = {out / "one.vprdb", "--query", world().walk("back"), "--c-l", "10"};
  check_failure("vpr-query", words, 2,
                "the automatic t_r needs two or more training sequences. Use --method filter, "
                "--score zscore --decide margin, or a number, as in --t-r 0.6.");
  const auto single =
      run_program("vpr-query", joined(words, {"--score", "zscore", "--decide", "margin"}));
  INFO(single.out << single.err);
  CHECK(single.exit_code == 0);
  CHECK(has(single.out, " = one "));
  check_failure("vpr-tune", {"threshold", out / "one.vprdb"}, 2, "two or more training sequences");
}

TEST_CASE(
    "by default, places are recognized at half to twice the speed, and the answer says why they "
    "are not") {
  const TemporaryFolder out;
  run_ok("vpr-train", {"fastable", "--train", world().walk("one"), "-o", out / "one.vprdb"});
  const auto query = [&](const std::string& walk, Words more = {}) {
    return run_ok("vpr-query", joined({out / "one.vprdb", "--query", world().walk(walk), "-o",
                                       out / "r.json", "--force"},
                                      more))
        .out;
  };
  const auto is_answer = [&](const std::string& text, const std::string& part) {
    INFO(text);
    CHECK(has(text, part));
    CHECK(has(text, "\nSettings: filter, margin 14\n"));
    CHECK(lines_of(text).size() <= 12);
    for (const std::string& line : lines_of(text))
      CHECK(line.size() <= 80 + out.path().string().size());
  };
  is_answer(query("one"), ", 1.0x\n");
  is_answer(query("one"), "next: vpr-eval ");
  is_answer(query("one", {"--speed", "2"}), ", 2.0x\n");
  is_answer(query("again", {"--speed", "reversed"}),
            "The query walked in the opposite direction: ");
  is_answer(query("other@0:12"), " (frames that differ clearly), and the filter needs");
  // A result repeats its run.
  query("one");
  const Json settings = file_json(out / "r.json")["settings"];
  CHECK(settings["method"] == "filter");
  const Json again = printed_json("vpr-query", {out / "one.vprdb", "--query", world().walk("one"),
                                                "--config", out / "r.json", "--json"});
  CHECK(again["settings"] == settings);
}

TEST_CASE("if nothing or everything is recognized, no looser threshold is suggested") {
  for (const Words& strict : {Words{"--t-r", "0.01"},
                              {"--score", "zscore", "--t-r", "-20"},
                              {"--score", "zscore", "--decide", "margin", "--margin", "60"}}) {
    const auto none = run_program("vpr-query", query_words(strict));
    INFO(none.out);
    CHECK(none.exit_code == 0);
    CHECK(has(none.out, " frames.\nUse --method filter without flags of windows.\n"));
    CHECK_FALSE(has(none.out, "--t-r "));
    CHECK_FALSE(has(none.out, "--margin "));
  }
  const auto other =
      run_program("vpr-query", {world().database(), "--query", world().walk("other") + "@0:12",
                                "--c-l", "10", "--t-r", "0.01"});
  INFO(other.out);
  CHECK(has(other.out, "and the filter needs"));
  CHECK_FALSE(has(other.out, "use --method filter"));
  const auto all = run_program("vpr-query", query_words({"--t-r", "1"}));
  CHECK(has(all.err, ": too many to tell places apart"));
  CHECK_FALSE(has(all.out, "vpr-query"));
}

TEST_CASE("tables can be text, CSV, Markdown and LaTeX") {
  const TemporaryFolder out;
  run_program("vpr-query", query_words({"-o", out / "r.json"}));
  const auto table = [&](const std::string& format) {
    return run_program("vpr-eval",
                       {out / "r.json", "--dataset", world().dataset(), "--format", format})
        .out;
  };
  CHECK(has(table("text"), "c_l"));
  CHECK(table("csv").find("name,method,query,c_l,t_r,scale,pairs correct,pairs incorrect,") == 0);
  CHECK(has(table("csv"), ",pairs by place correct,"));
  CHECK_FALSE(has(table("text"), "by place"));
  CHECK(has(table("markdown"), "| c_l |"));
  CHECK(has(table("latex"), "\\begin{tabular}"));
}

TEST_CASE("without ground truth, a result has totals, charts and a map, but no metrics") {
  const TemporaryFolder out;
  run_ok("vpr-query", query_words({"-o", out / "r.json"}));
  const auto eval = [&](Words more) {
    return run_program("vpr-eval", joined({out / "r.json"}, more));
  };
  const auto looked = ok(eval({"--html", out / "page.html", "--query", world().walk("back")}));
  CHECK(looked.err.empty());
  CHECK(has(looked.out, "Nothing is judged"));
  CHECK(has(looked.out, "back "));  // the recognized ranges
  CHECK_FALSE(has(looked.out, "correct"));
  const std::string page = read_text(out / "page.html");
  CHECK(has(page, "recognized, not judged"));
  CHECK(has(page, "data:image/jpeg"));
  check_failure(eval({"--tolerance", "3"}), 2, "there is no ground truth");
  check_failure(run_program("vpr-eval", {out / "r.json", out / "r.json"}), 2,
                "there is no ground truth");
  Json bare = file_json(world().dataset());
  const auto folder = fs::path(world().dataset()).parent_path();
  for (Json* one : {&bare["train"][0], &bare["train"][1], &bare["queries"][0]}) {
    one->erase("ground_truth");
    for (const char* key : {"sequence", "poses"})
      (*one)[key] = (folder / (*one)[key].get<std::string>()).string();
  }
  bare.erase("plan");
  write_text(out / "bare.json", bare.dump());
  const auto found = ok(eval({"--dataset", out / "bare.json", "-o", out / "e.json", "--map",
                              out / "map", "--plot", out / "plots"}));
  CHECK(found.err.empty());
  CHECK(has(found.out, "next: judge each place by its images with --ask-places PAGE.html\n"));
  CHECK(has(read_text(out / "map/map.svg"), "recognized, not judged"));
  CHECK_FALSE(has(read_text(out / "map/map.svg"), "nothing to recognize"));
  CHECK(fs::exists(out / "plots/timeline.svg"));
  const Json report = file_json(out / "e.json");
  const Json judged =
      printed_json("vpr-eval", {out / "r.json", "--dataset", world().dataset(), "--json"});
  const auto total = [](const Json& counts) {
    return counts["correct"].get<int>() + counts["incorrect"].get<int>() +
           counts["ignored"].get<int>();
  };
  for (const char* key : {"pairs", "places"})
    CHECK(report["counts"][key]["ignored"] == total(judged["counts"][key]));
  CHECK(report["localization"]["recognized"] == judged["localization"]["recognized"]);
  CHECK(report["localization"]["recognized"].get<int>() > 5);
  check_failure("vpr-eval", {"compare", out / "e.json", out / "e.json"}, 2, "without ground truth");
}

TEST_CASE("answers to places judge a result, and only this one") {
  const TemporaryFolder out;
  run_ok("vpr-query",
         query_words({"--t-r", "0.6", "--t-r-scale", "relative", "-o", out / "r.json"}));
  run_ok("vpr-query", {world().database(), "--dataset", world().dataset(), "--c-l", "5", "--t-r",
                       "0.6", "-o", out / "other.json"});
  const Json pairs =
      printed_json("vpr-eval", {out / "r.json", "--dataset", world().dataset(), "--json"});
  // Answers that equal the ground truth at the representatives.
  const auto answers = [&](const Json& places) {
    std::string text = "place,query,sequence,train,same\n";
    for (size_t i = 0; i < places.size(); ++i)
      text += fmt::format("{},{},{},{},{}\n", i + 1, places[i]["query"].get<int>(),
                          places[i]["sequence"].get<std::string>(), places[i]["train"].get<int>(),
                          places[i]["label"] == "same" ? "yes" : "no");
    return text;
  };
  write_text(out / "p.csv", answers(pairs["recognized_places"]));
  const auto eval = [&](const std::string& result, Words more) {
    return run_program("vpr-eval", joined({out / result, "--places", out / "p.csv"}, more));
  };
  const Json report =
      printed_json(eval("r.json", {"--dataset", world().dataset(), "--json", "-v"}));
  CHECK(report["judged"] == "places");
  for (const char* key : {"pairs_by_place", "places"})
    CHECK(report["counts"][key] == pairs["counts"][key]);
  CHECK(report["counts"]["distinct"] == pairs["counts"]["distinct"]);
  for (const char* key : {"best_match", "metrics", "curves"}) CHECK_FALSE(report.contains(key));
  const auto text = ok(eval("r.json", {"-v"}));
  CHECK(has(text.out, "  places        "));
  CHECK(has(text.out, "pairs correct"));
  check_failure(eval("other.json", {}), 4, "The answers are of another result");
  check_failure(eval("r.json", {"--ground-truth", "aligned"}), 2, "Omit --ground-truth");
  check_failure(run_program("vpr-eval", {out / "r.json", out / "r.json", "--places", "p"}), 2,
                "take one result");
  ok(eval("r.json", {"--ask-places", out / "found.html"}));  // by the paths of the run
  CHECK(has(read_text(out / "found.html"), "data:image/jpeg"));
  Json moved = file_json(out / "r.json");
  moved["machine"]["paths"]["query"] = out / "gone";
  write_text(out / "r.json", moved.dump());
  check_failure(eval("r.json", {"--ask-places", out / "q.html"}), 2, "have moved or changed");
  CHECK_FALSE(fs::exists(out / "q.html"));
  ok(eval("r.json", {"--dataset", world().dataset(), "--ask-places", out / "q.html"}));
  CHECK(has(read_text(out / "q.html"), "data:image/jpeg"));
  run_ok("vpr-query", {world().fabmap(), "--query", world().walk("back"), "-o", out / "f.json"});
  check_failure(eval("f.json", {}), 2, "FAB-MAP has none");
  write_text(out / "p.csv", "");
  check_failure(eval("r.json", {}), 4, "p.csv");
}

TEST_CASE("a map shows one or two results of the same query, as SVG and PNG") {
  const TemporaryFolder out;
  for (const char* name : {"a", "b"})
    run_ok("vpr-query", query_words({"-o", (out / name).string() + ".json"}));
  const auto eval = [&](Words more) {
    return run_program("vpr-eval", joined({out / "a.json"}, more));
  };
  CHECK(eval({"--map", out / "m"}).exit_code == 2);  // without a data set
  fs::copy(world().folder() / "walk", out / "walk", fs::copy_options::recursive);
  write_text(out / "walk/back/poses.csv", "frame,x,y\n");
  CHECK(eval({"--dataset", out / "walk/two_walks.json", "--map", out / "m"}).exit_code == 4);
  CHECK(eval({"--dataset", world().dataset(), "--map-with", out / "b.json"}).exit_code == 2);
  CHECK(eval({out / "b.json", "--dataset", world().dataset(), "--map-with", out / "b.json"})
            .exit_code == 2);
  ok(eval({"--dataset", world().dataset(), "--map", out / "m", "--map-with", out / "b.json"}));
  CHECK(list_folder(out / "m") == Words{".vpr-files", "map.png", "map.svg"});
  CHECK_FALSE(has(read_text(out / "m/map.svg"), "recognized, incorrect"));
  CHECK(has(read_text(out / "m/map.svg"), "recognized, correct"));
}
