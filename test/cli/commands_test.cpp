// The programs on a small generated world.
#include <catch2/catch.hpp>

#include "cli/building.h"
#include "cli/world.h"
#include "npz.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

const std::string kQueryWorld = "vpr-query $db --dataset $dataset --c-l 10 ";

}  // namespace

TEST_CASE("train, query and evaluate yield correct counts") {
  const auto query = run_ok(kQueryWorld + "-o r.json");
  // Similar corridors lower the automatic t_r.
  CHECK(query.err.starts_with("warning: one and two seem to show the same place"));
  const Json report = printed_json("vpr-eval r.json --dataset $dataset -o e.json --json");
  CHECK(report == file_json("e.json"));
  CHECK(report["counts"]["pairs"]["correct"].get<int>() > 20);
  CHECK(report["counts"]["pairs"]["incorrect"] == 0);
  CHECK(report["counts"]["pairs_by_cluster"]["correct"].get<int>() > 20);
  CHECK(report["counts"]["distinct"].get<int>() >= 1);
  CHECK(report["best_match"]["rate"].get<double>() > 0.7);
  for (const std::string method : {"openable", "fastable-online"}) {
    run(kQueryWorld + ("-o " + method + ".json --method " + method + " --max-memory 1M"));
    CHECK(npz_bytes(method + ".npz", "recognitions") == npz_bytes("r.npz", "recognitions"));
  }
}

TEST_CASE("outputs are the same bytes for any number of threads and SIMD target") {
  const auto write = [](const std::string& command, const std::string& folder,
                        const std::string& threads, const std::string& target) {
    fs::create_directory(folder);
    fs::current_path(folder);
    run_ok(command + " --threads " + threads, "VPR_SIMD=" + target);
    fs::current_path("..");
  };
  for (const std::string command :
       {"vpr-train fastable --dataset $dataset --c-l 10 -o d.vprdb",
        "vpr-train fabmap --pretrain $other --features sift --words 60 --train $one -o d.vprdb",
        "vpr-query $db --query $back --c-l 10 -o r.json",
        "vpr-query $db --query $back --speed varying -o r.json",
        "vpr-query loops --query $back --c-l 4 --gap 15 --score zscore --save-loops l.csv -o "
        "r.json",
        "vpr-tune $db --query $back --ground-truth $truth -o t.json",
        "vpr-tune fastable $db --query $back --ground-truth $truth --c-l 2,10 -o s.json"}) {
    INFO(command);
    write(command, "one", "1", simd_targets().front());
    write(command, "other", "3", simd_targets().back());
    for (const auto& entry : fs::recursive_directory_iterator("one")) {
      if (!entry.is_regular_file()) continue;
      const fs::path same = "other" / fs::relative(entry.path(), "one");
      INFO(same);
      if (same.extension() == ".json")
        CHECK(comparable(file_json(entry.path())) == comparable(file_json(same)));
      else
        CHECK(read_text(entry.path()) == read_text(same));
      CHECK_FALSE((same.filename() == "manifest.json" && has(read_text(same), "/tmp")));
    }
    for (const char* folder : {"one", "other"}) fs::remove_all(folder);
  }
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
            "vpr-train add a.vprdb --train $one@0:20 -o x.vprdb --json")["sequences"][1]["name"] ==
        "one@0:20");
}

TEST_CASE("each subfolder is a training sequence with --train-folders") {
  const Json info = printed_json("vpr-train fastable --train-folders $walk -o all.vprdb --json");
  CHECK(info["sequences"].size() == 5);
}

TEST_CASE("a saved matrix holds every distance and can be drawn") {
  run_ok(kQueryWorld + "-o r.json --save-matrix d.npy");
  const Json result = file_json("r.json");
  const NpyArray matrix("d.npy");
  const auto values = matrix.values<int32_t>(2);
  CHECK(matrix.shape()[0] == result["query"]["windows"]);
  CHECK(matrix.shape()[1] == result["matrix"]["columns"]);
  const auto cells = npz_array<int32_t>("r.npz", "recognitions");
  const auto scores = npz_array<double>("r.npz", "recognition_scores");
  const auto second = result["matrix"]["sequences"][1]["first_column"].get<int>();
  for (const auto& v : values) REQUIRE((v >= 0 && v <= 13860));
  REQUIRE(cells.size() == 3 * scores.size());
  for (size_t i = 0; i < scores.size(); ++i)
    REQUIRE(values[size_t(cells[3 * i]) * matrix.shape()[1] +
                   size_t(cells[3 * i + 1] == 0 ? 0 : second) + size_t(cells[3 * i + 2])] ==
            scores[i]);
  CHECK(scores.size() > 0);
  run_ok(kQueryWorld + "-o p.json --save-matrix d.png");
  CHECK(read_text("d.png").substr(1, 3) == "PNG");
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
}

TEST_CASE("a result can be used as its own settings") {
  for (const std::string settings : {"--t-r 0.6 --seed 7 ", "", "--score zscore --t-r -1 "}) {
    run_ok(kQueryWorld + settings + "-o r.json --force");
    const Json first = file_json("r.json");
    const Json second = printed_json("vpr-query $db --dataset $dataset --config r.json --json");
    CHECK(second["settings"] == first["settings"]);
    CHECK(second["provenance"]["seed"] == first["provenance"]["seed"]);
    CHECK(second["totals"] == first["totals"]);
  }
  std::string damaged = read_text("r.json");
  damaged.replace(damaged.find("\"c_l\": 10"), 9, "\"c_l\": 11");
  write_text("d.json", damaged);
  CHECK(run(kQueryWorld + "--config d.json").exit_code == 4);
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
  const auto query = run_ok(kQueryWorld);
  CHECK(query.out.starts_with("Recognized "));
  CHECK(has(query.out, " = one "));  // a range of the sequence "one"
  CHECK(has(query.out, "\nSettings: FastABLE, c_l 10, t_r "));
  run_ok("vpr-train fastable --train $one --c-l 10 -o one.vprdb");
  const std::string words = "vpr-query one.vprdb --query $back --c-l 10";
  check_failure(
      words, 2,
      "an automatic t_r needs two or more training sequences, and the database has one. For "
      "vpr-query --c-l, add --t-r 0.6, or --score zscore --decide margin");
  CHECK(has(run_ok(words + " --score zscore --decide margin").out, " = one "));
}

TEST_CASE(
    "by default, places are recognized at half to twice the speed, and the answer says why they "
    "are not") {
  run_ok("vpr-train fastable --train $one -o one.vprdb");
  const auto query = [&](const std::string& walk, std::string more = "") {
    return run_ok("vpr-query one.vprdb -o r.json --force --query $" + walk + " " + more).out;
  };
  const auto is_answer = [&](const std::string& text, const std::string& part) {
    CHECK(has(text, part));
    CHECK(has(text, "\nSettings: filter, margin 14 deviations\n"));
    check_screen(text);
  };
  is_answer(query("one"), ", 1.0x");
  is_answer(query("one"), "next: vpr-eval ");
  is_answer(query("one", "--speed 2"), ", 2.0x");
  is_answer(query("again", "--speed reversed"), "The query walked in the opposite direction: ");
  is_answer(query("other@0:12"), " (frames that differ clearly), and the filter needs");
}

TEST_CASE("if nothing or everything is recognized, no looser threshold is suggested") {
  for (const std::string strict :
       {"--t-r 0.01", "--score zscore --t-r -20", "--score zscore --decide margin --margin 60"}) {
    const auto none = run_ok(kQueryWorld + strict);
    INFO(none.out);
    CHECK(has(none.out, "With default settings (--method filter, margin 14), "));
    CHECK_FALSE(has(none.out, "--t-r "));
    CHECK_FALSE(has(none.out, "--margin "));
  }
  const auto other = run("vpr-query $db --query $other@0:12 --c-l 10 --t-r 0.01");
  INFO(other.out);
  CHECK(has(other.out, "and the filter needs"));
  CHECK_FALSE(has(other.out, "use --method filter"));
  const auto all = run(kQueryWorld + "--t-r 1");
  CHECK(has(all.err, ": too many to tell places apart"));
  CHECK_FALSE(has(all.out, "vpr-query"));
}

TEST_CASE("without ground truth, a result has totals, charts and a map, but no metrics") {
  run_ok(kQueryWorld + "-o r.json");
  const auto eval = [&](const std::string& more) { return run("vpr-eval r.json " + more); };
  const auto looked = ok(eval("--html page.html --query $back"));
  CHECK(looked.err.empty());
  CHECK(has(looked.out, "Nothing is judged"));
  CHECK(has(looked.out, "back "));  // the recognized ranges
  CHECK_FALSE(has(looked.out, "correct"));
  CHECK(has(read_text("page.html"), "data:image/jpeg"));
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
  check_failure("vpr-eval compare e.json e.json", 2, "without ground truth");
}

TEST_CASE("answers to places judge a result, and only this one") {
  run_ok(kQueryWorld + "--t-r 0.6 --t-r-scale relative -o r.json");
  run_ok("vpr-query $db --dataset $dataset --c-l 5 --t-r 0.6 -o other.json");
  const Json place = printed_json("vpr-eval r.json --json")["clusters"][0];
  write_text("p.csv",
             fmt::format("place,query,sequence,train,same\n1,{},{},{},yes\n", place["query"].dump(),
                         place["sequence"].get<std::string>(), place["train"].dump()));
  const auto eval = [&](const std::string& result, const std::string& more) {
    return run("vpr-eval " + result + " --places p.csv " + more);
  };
  const auto text = ok(eval("r.json", "-v"));
  CHECK(has(text.out, "  places        "));
  CHECK(has(text.out, "pairs correct"));
  check_failure(eval("other.json", ""), 4, "The answers are of another result");
  check_failure(eval("r.json", "--ground-truth aligned"), 2, "Omit --ground-truth");
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

TEST_CASE("images that were replaced under the same names are neither asked about nor shown") {
  for (const std::string side : {"query", "train"}) {
    INFO(side);
    for (const std::string folder : {"query", "train"}) {
      fs::remove_all(folder);
      fs::copy(world().walk("back"), folder, fs::copy_options::recursive);
    }
    run_ok("vpr-train fastable --train train -o t.vprdb --force --quiet");
    run_ok("vpr-query t.vprdb --query query -o r.json --force --quiet");
    const Words names = images_of(side);
    ok(run("vpr-eval r.json --ask-frames q.html --force"));
    const auto same = ok(run("vpr-eval r.json --html page.html --force"));
    CHECK_FALSE(has(same.err, "have moved or changed"));
    for (size_t i = 0; i < names.size(); ++i)  // the same images in reverse order
      fs::copy_file(fs::path(world().walk("back")) / names[names.size() - 1 - i],
                    fs::path(side) / names[i], fs::copy_options::overwrite_existing);
    check_failure(run("vpr-eval r.json --ask-frames q.html --force"), 2, "have moved or changed");
    check_failure(run("vpr-eval r.json --ask-places q.html --force"), 2, "have moved or changed");
    const auto page = ok(run("vpr-eval r.json --html page.html --force"));
    CHECK(has(page.err, "the page lacks images: the images of the run have moved or changed"));
    ok(run("vpr-eval r.json --ask-frames q.html --force --query query --train train"));
    if (side == "query") continue;
    for (size_t i = 0; i + 1 < names.size(); ++i)  // only the last one remains another one
      fs::copy_file(fs::path(world().walk("back")) / names[i], fs::path(side) / names[i],
                    fs::copy_options::overwrite_existing);
    check_failure(run("vpr-eval r.json --ask-frames q.html --force"), 2, "have moved or changed");
  }
}

TEST_CASE("a result that replaces one of another method leaves no array of it") {
  run_ok("vpr-query $db --query $back --method filter -o r.json");
  CHECK_FALSE(npz_bytes("r.npz", "path").empty());
  run_ok("vpr-query $db --query $back --c-l 5 --score zscore --decide margin -o r.json --force");
  CHECK(npz_bytes("r.npz", "path").empty());
  run_ok("vpr-eval r.json");
  run_ok("vpr-query $db --query $back --method filter -o other.json");
  run_ok("vpr-eval other.json -o r.json --force");
  CHECK_FALSE(fs::exists("r.npz"));
  CHECK(fs::exists("other.npz"));
}

TEST_CASE("a map shows one or two results of the same query, as SVG and PNG") {
  for (const std::string name : {"a", "b"}) run_ok(kQueryWorld + "-o " + name + ".json");
  const auto eval = [&](const std::string& more) { return run("vpr-eval a.json " + more); };
  fs::copy(world().folder() / "walk", "walk", fs::copy_options::recursive);
  write_text("walk/back/poses.csv", "frame,x,y\n");
  CHECK(eval("--dataset walk/two_walks.json --map m").exit_code == 4);
  CHECK(eval("b.json --dataset $dataset --map-with b.json").exit_code == 2);
  ok(eval("--dataset $dataset --map m --map-with b.json"));
  CHECK(list_folder("m") == Words{".vpr-files", "map.pdf", "map.png", "map.svg"});
  CHECK_FALSE(has(read_text("m/map.svg"), "recognized, incorrect"));
  CHECK(has(read_text("m/map.svg"), "recognized, correct"));
}
