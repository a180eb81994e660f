// The programs on a small generated world.
#include <catch2/catch.hpp>

#include "cli/building.h"
#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

const std::string kQuery = "vpr-query $db --dataset $dataset --c-l 10 ";

}  // namespace

TEST_CASE("train, query and evaluate yield correct counts") {
  const auto query = run_ok(kQuery + "-o r.json --verify 500");
  CHECK(has(query.out, "500 cells, 0 differences"));
  // Similar corridors lower the automatic t_r.
  CHECK(query.err.starts_with("warning: one and two seem to show the same place"));
  const Json report = printed_json("vpr-eval r.json --dataset $dataset -o e.json --json");
  CHECK(report == file_json("e.json"));
  CHECK(report["counts"]["pairs"]["correct"].get<int>() > 20);
  CHECK(report["counts"]["pairs"]["incorrect"] == 0);
  CHECK(report["counts"]["pairs_by_place"]["correct"].get<int>() > 20);
  CHECK(report["counts"]["distinct"].get<int>() >= 1);
  CHECK(report["best_match"]["rate"].get<double>() > 0.7);
}

TEST_CASE("results are byte-identical for any threads, SIMD target and method") {
  run(kQuery + "-o a.json --threads 1");
  const Json expected = comparable(file_json("a.json"));
  const std::string recognitions = read_text("a.recognitions.npy");
  for (const std::string& target : simd_targets()) {
    const std::string name = "r" + target;
    run_ok(kQuery + ("-o " + name + ".json --threads 2"), "VPR_SIMD=" + target);
    CHECK(comparable(file_json(name + ".json")) == expected);
    CHECK(read_text(name + ".recognitions.npy") == recognitions);
  }
  for (const std::string method : {"openable", "fastable-online"}) {
    run(kQuery + ("-o " + method + ".json --method " + method + " --max-memory 1M"));
    CHECK(read_text(method + ".recognitions.npy") == recognitions);
  }
}

TEST_CASE("databases are byte-identical for any number of threads, and name no path or host") {
  run_ok("vpr-train fastable --dataset $dataset --c-l 10 -o b.vprdb --threads 1");
  for (const std::string name : {"manifest.json", "codes.npy", "frames.txt"})
    CHECK(read_text("b.vprdb/" + name) == read_text(fs::path(world().database()) / name));
  CHECK_FALSE(has(read_text("b.vprdb/manifest.json"), "/tmp"));
}

TEST_CASE("a rendered world is byte-identical for its seed and any number of threads") {
  run_ok("vpr-synth $walk/../world.json -o w --threads 1");
  for (const auto& entry : fs::recursive_directory_iterator("w"))
    if (entry.is_regular_file())
      REQUIRE(read_text(entry.path()) ==
              read_text(world().folder() / "walk" / fs::relative(entry.path(), "w")));
}

TEST_CASE("adding a sequence yields the database of training both together") {
  run_ok("vpr-train fastable --train $one --c-l 10 -o a.vprdb");
  run_ok("vpr-train add a.vprdb --train $two -o ab.vprdb");
  run_ok("vpr-train fastable --train $one --train $two --c-l 10 -o both.vprdb");
  CHECK(read_text("ab.vprdb/manifest.json") == read_text("both.vprdb/manifest.json"));
  const Json info = printed_json("vpr-train info ab.vprdb --json");
  CHECK(info["sequences"][1]["name"] == "two");
  CHECK(info["descriptor"] == "ldb+hog");
  CHECK(printed_json(
            "vpr-train add a.vprdb --train $one -o x.vprdb --json")["sequences"][1]["name"] ==
        "walk/one");
}

TEST_CASE("each subfolder is a training sequence with --train-folders") {
  CHECK(printed_json(
            "vpr-train fastable --train-folders $walk --c-l 10 -o all.vprdb --json")["sequences"]
            .size() == 5);
}

TEST_CASE("a saved matrix holds every distance and can be drawn") {
  run_ok(kQuery + "-o r.json --save-matrix d.npy");
  const Json result = file_json("r.json");
  const NpyArray matrix("d.npy");
  const auto values = matrix.values<int32_t>(2);
  CHECK(matrix.shape()[0] == result["query"]["windows"]);
  CHECK(matrix.shape()[1] == result["matrix"]["columns"]);
  const NpyArray recognitions("r.recognitions.npy");
  const auto cells = recognitions.values<int32_t>(2);
  const auto scores = read_array<double>("r.recognition_scores.npy");
  const auto second = result["matrix"]["sequences"][1]["first_column"].get<int>();
  for (const auto& v : values) REQUIRE((v >= 0 && v <= 13860));
  for (size_t i = 0; i < recognitions.shape()[0]; ++i)
    REQUIRE(values[size_t(cells[3 * i]) * matrix.shape()[1] +
                   size_t(cells[3 * i + 1] == 0 ? 0 : second) + size_t(cells[3 * i + 2])] ==
            scores[i]);
  CHECK(recognitions.shape()[0] > 0);
  run_ok(kQuery + "-o p.json --save-matrix d.png");
  CHECK(read_text("d.png").substr(1, 3) == "PNG");
}

TEST_CASE("skipped unreadable frames split windows and are -1 in a matrix") {
  fs::copy(world().walk("back"), "back");
  write_text("back/00020.png", "broken");
  const std::string query = "vpr-query $db --query back --c-l 10 -o r.json";
  check_failure(query, 3, "00020.png");
  run_ok(query + " --skip-unreadable --save-matrix d.npy --verify 99");
  const NpyArray best("r.best.npy");
  const auto rows = best.values<int32_t>(2);
  const NpyArray matrix("d.npy");
  const auto values = matrix.values<int32_t>(2);
  for (size_t window = 0; window < best.shape()[0]; ++window) {
    const bool broken = window >= 11 && window <= 20;
    REQUIRE((rows[3 * window + 1] == -1) == broken);
    REQUIRE((values[window * matrix.shape()[1]] == -1) == broken);
  }
}

TEST_CASE("a search can be limited to a sequence by name") {
  run_ok(kQuery + "--only-sequence two -o r.json");
  const Json result = file_json("r.json");
  CHECK(result["sequences"][0]["searched"] == false);
  check_failure(kQuery + "--only-sequence three --json", 2, "one, two");
}

TEST_CASE("settings are read from a file, and flags take precedence") {
  write_text("c.json", R"({"schema": "vpr.config/3", "c_l": 5, "t_r": 0.3, "seed": 9,
                                       "clustering": {"eps": 3}})");
  const std::string query = "vpr-query $db --dataset $dataset --json --config c.json";
  const Json from_file = printed_json(query);
  CHECK(from_file["settings"]["c_l"] == 5);
  CHECK(from_file["settings"]["t_r"] == 0.3);
  CHECK(from_file["settings"]["clustering"]["eps"] == 3);
  CHECK(from_file["provenance"]["seed"] == 9);
  CHECK(printed_json(query + " --t-r 0.5")["settings"]["t_r"] == 0.5);
  write_text("c.json", R"({"t_l": 5})");
  check_failure(query, 2, "did you mean");
  write_text("c.json", R"({"c_l": 5, "t_p": 0.3})");
  check_failure(query, 2, "t_p has no effect with a database for fastable");
}

TEST_CASE("a result can be used as its own settings") {
  for (const std::string settings : {"--t-r 0.6 --seed 7 ", "", "--score zscore --t-r -1 "}) {
    run_ok(kQuery + settings + "-o r.json --force");
    const Json first = file_json("r.json");
    const Json second = printed_json("vpr-query $db --dataset $dataset --config r.json --json");
    CHECK(second["settings"] == first["settings"]);
    CHECK(second["provenance"]["seed"] == first["provenance"]["seed"]);
    CHECK(second["totals"] == first["totals"]);
  }
  std::string damaged = read_text("r.json");
  damaged.replace(damaged.find("\"c_l\": 10"), 9, "\"c_l\": 11");
  write_text("d.json", damaged);
  CHECK(run(kQuery + "--config d.json").exit_code == 4);
}

TEST_CASE("a world is rendered with the seed of a configuration file") {
  write_text("c.json", R"({"seed": 9})");
  for (const uint64_t seed : {1, 9}) {
    Json json = Json::parse(building(seed, {"one"}));
    json["walks"][0]["frames"] = 2;
    write_text("world.json", json.dump());
    run_ok("vpr-synth world.json -o " + std::to_string(seed) +
           (seed == 1 ? " --config c.json" : ""));
  }
  CHECK(read_text("1/one/poses.csv") == read_text("9/one/poses.csv"));
}

TEST_CASE("a database and a query are sufficient") {
  const auto query = run_ok(kQuery);
  CHECK(query.out.starts_with("Recognized "));
  CHECK(has(query.out, " = one "));  // a range of the sequence "one"
  CHECK(has(query.out, "\nSettings: fastable, c_l 10, raw, t_r "));
  run_ok("vpr-train fastable --train $one --c-l 10 -o one.vprdb");
  const std::string words = "vpr-query one.vprdb --query $back --c-l 10";
  check_failure(words, 2,
                "the automatic t_r needs two or more training sequences. Use --method filter, "
                "--score zscore --decide margin, or a number, as in --t-r 0.6.");
  CHECK(has(run_ok(words + " --score zscore --decide margin").out, " = one "));
  check_failure("vpr-tune threshold one.vprdb", 2, "two or more training sequences");
}

TEST_CASE(
    "by default, places are recognized at half to twice the speed, and the answer says why they "
    "are not") {
  run_ok("vpr-train fastable --train $one -o one.vprdb");
  const auto query = [&](const std::string& walk, std::string more = "") {
    return run_ok("vpr-query one.vprdb -o r.json --force --query $" + walk + " " + more).out;
  };
  const auto is_answer = [&](const std::string& text, const std::string& part) {
    INFO(text);
    CHECK(has(text, part));
    CHECK(has(text, "\nSettings: filter, margin 14\n"));
    CHECK(lines_of(text).size() <= 12);
    for (const std::string& line : lines_of(text)) CHECK(line.size() <= 80);
  };
  is_answer(query("one"), ", 1.0x\n");
  is_answer(query("one"), "next: vpr-eval ");
  is_answer(query("one", "--speed 2"), ", 2.0x\n");
  is_answer(query("again", "--speed reversed"), "The query walked in the opposite direction: ");
  is_answer(query("other@0:12"), " (frames that differ clearly), and the filter needs");
  // A result repeats its run.
  query("one");
  const Json settings = file_json("r.json")["settings"];
  CHECK(settings["method"] == "filter");
  const Json again = printed_json("vpr-query one.vprdb --query $one --config r.json --json");
  CHECK(again["settings"] == settings);
}

TEST_CASE("if nothing or everything is recognized, no looser threshold is suggested") {
  for (const std::string strict :
       {"--t-r 0.01", "--score zscore --t-r -20", "--score zscore --decide margin --margin 60"}) {
    const auto none = run_ok(kQuery + strict);
    INFO(none.out);
    CHECK(has(none.out, " frames.\nUse --method filter without flags of windows.\n"));
    CHECK_FALSE(has(none.out, "--t-r "));
    CHECK_FALSE(has(none.out, "--margin "));
  }
  const auto other = run("vpr-query $db --query $other@0:12 --c-l 10 --t-r 0.01");
  INFO(other.out);
  CHECK(has(other.out, "and the filter needs"));
  CHECK_FALSE(has(other.out, "use --method filter"));
  const auto all = run(kQuery + "--t-r 1");
  CHECK(has(all.err, ": too many to tell places apart"));
  CHECK_FALSE(has(all.out, "vpr-query"));
}

TEST_CASE("tables can be text, CSV, Markdown and LaTeX") {
  run(kQuery + "-o r.json");
  const auto table = [&](const std::string& format) {
    return run("vpr-eval r.json --dataset $dataset --format " + format).out;
  };
  CHECK(has(table("text"), "c_l"));
  CHECK(table("csv").find("name,method,query,c_l,t_r,scale,pairs correct,pairs incorrect,") == 0);
  CHECK(has(table("csv"), ",pairs by place correct,"));
  CHECK_FALSE(has(table("text"), "by place"));
  CHECK(has(table("markdown"), "| c_l |"));
  CHECK(has(table("latex"), "\\begin{tabular}"));
}

TEST_CASE("without ground truth, a result has totals, charts and a map, but no metrics") {
  run_ok(kQuery + "-o r.json");
  const auto eval = [&](const std::string& more) { return run("vpr-eval r.json " + more); };
  const auto looked = ok(eval("--html page.html --query $back"));
  CHECK(looked.err.empty());
  CHECK(has(looked.out, "Nothing is judged"));
  CHECK(has(looked.out, "back "));  // the recognized ranges
  CHECK_FALSE(has(looked.out, "correct"));
  const std::string page = read_text("page.html");
  CHECK(has(page, "recognized, not judged"));
  CHECK(has(page, "data:image/jpeg"));
  check_failure(eval("--tolerance 3"), 2, "there is no ground truth");
  check_failure(run("vpr-eval r.json r.json"), 2, "there is no ground truth");
  Json bare = file_json(world().dataset());
  for (Json* one : {&bare["train"][0], &bare["train"][1], &bare["queries"][0]}) {
    one->erase("ground_truth");
    for (const std::string key : {"sequence", "poses"})
      (*one)[key] = world().walk((*one)[key].get<std::string>());
  }
  bare.erase("plan");
  write_text("bare.json", bare.dump());
  const auto found = ok(eval("--dataset bare.json -o e.json --map map --plot plots"));
  CHECK(found.err.empty());
  CHECK(has(found.out, "next: judge each place by its images with --ask-places PAGE.html\n"));
  CHECK(has(read_text("map/map.svg"), "recognized, not judged"));
  CHECK_FALSE(has(read_text("map/map.svg"), "nothing to recognize"));
  CHECK(fs::exists("plots/timeline.svg"));
  const Json report = file_json("e.json");
  const Json judged = printed_json("vpr-eval r.json --dataset $dataset --json");
  const auto total = [](const Json& counts) {
    return counts["correct"].get<int>() + counts["incorrect"].get<int>() +
           counts["ignored"].get<int>();
  };
  for (const std::string key : {"pairs", "places"})
    CHECK(report["counts"][key]["ignored"] == total(judged["counts"][key]));
  CHECK(report["localization"]["recognized"] == judged["localization"]["recognized"]);
  CHECK(report["localization"]["recognized"].get<int>() > 5);
  check_failure("vpr-eval compare e.json e.json", 2, "without ground truth");
}

TEST_CASE("answers to places judge a result, and only this one") {
  run_ok(kQuery + "--t-r 0.6 --t-r-scale relative -o r.json");
  run_ok("vpr-query $db --dataset $dataset --c-l 5 --t-r 0.6 -o other.json");
  const Json pairs = printed_json("vpr-eval r.json --dataset $dataset --json");
  // Answers that equal the ground truth at the representatives.
  const auto answers = [&](const Json& places) {
    std::string text = "place,query,sequence,train,same\n";
    for (size_t i = 0; i < places.size(); ++i)
      text += fmt::format("{},{},{},{},{}\n", i + 1, places[i]["query"].get<int>(),
                          places[i]["sequence"].get<std::string>(), places[i]["train"].get<int>(),
                          places[i]["label"] == "same" ? "yes" : "no");
    return text;
  };
  write_text("p.csv", answers(pairs["recognized_places"]));
  const auto eval = [&](const std::string& result, const std::string& more) {
    return run("vpr-eval " + result + " --places p.csv " + more);
  };
  const Json report = printed_json(eval("r.json", "--dataset $dataset --json -v"));
  CHECK(report["judged"] == "places");
  for (const std::string key : {"pairs_by_place", "places"})
    CHECK(report["counts"][key] == pairs["counts"][key]);
  CHECK(report["counts"]["distinct"] == pairs["counts"]["distinct"]);
  for (const std::string key : {"best_match", "metrics", "curves"})
    CHECK_FALSE(report.contains(key));
  const auto text = ok(eval("r.json", "-v"));
  CHECK(has(text.out, "  places        "));
  CHECK(has(text.out, "pairs correct"));
  check_failure(eval("other.json", ""), 4, "The answers are of another result");
  check_failure(eval("r.json", "--ground-truth aligned"), 2, "Omit --ground-truth");
  check_failure(run("vpr-eval r.json r.json --places p"), 2, "take one result");
  ok(eval("r.json", "--ask-places found.html"));  // by the paths of the run
  CHECK(has(read_text("found.html"), "data:image/jpeg"));
  Json moved = file_json("r.json");
  moved["machine"]["paths"]["query"] = "gone";
  write_text("r.json", moved.dump());
  check_failure(eval("r.json", "--ask-places q.html"), 2, "have moved or changed");
  CHECK_FALSE(fs::exists("q.html"));
  ok(eval("r.json", "--dataset $dataset --ask-places q.html"));
  CHECK(has(read_text("q.html"), "data:image/jpeg"));
  run_ok("vpr-query $fabmap --query $back -o f.json");
  check_failure(eval("f.json", ""), 2, "FAB-MAP has none");
  write_text("p.csv", "");
  check_failure(eval("r.json", ""), 4, "p.csv");
}

TEST_CASE("a map shows one or two results of the same query, as SVG and PNG") {
  for (const std::string name : {"a", "b"}) run_ok(kQuery + "-o " + name + ".json");
  const auto eval = [&](const std::string& more) { return run("vpr-eval a.json " + more); };
  CHECK(eval("--map m").exit_code == 2);  // without a data set
  fs::copy(world().folder() / "walk", "walk", fs::copy_options::recursive);
  write_text("walk/back/poses.csv", "frame,x,y\n");
  CHECK(eval("--dataset walk/two_walks.json --map m").exit_code == 4);
  CHECK(eval("--dataset $dataset --map-with b.json").exit_code == 2);
  CHECK(eval("b.json --dataset $dataset --map-with b.json").exit_code == 2);
  ok(eval("--dataset $dataset --map m --map-with b.json"));
  CHECK(list_folder("m") == Words{".vpr-files", "map.png", "map.svg"});
  CHECK_FALSE(has(read_text("m/map.svg"), "recognized, incorrect"));
  CHECK(has(read_text("m/map.svg"), "recognized, correct"));
}
