// FAB-MAP's commands, and damage in all their files.
#include <algorithm>
#include <array>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"
#include "words/database.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

const std::string kGrayImage = "P5\n32 32\n255\n" + std::string(1024, '\x80');

RunOutcome run_train(Words more) {
  return run_program("vpr-train", joined({"fabmap", "--pretrain", world().walk("other"),
                                          "--features", "sift", "--words", "60"},
                                         more));
}

RunOutcome run_query(Words more) {
  return run_program(
      "vpr-query",
      joined({world().fabmap(), "--query", world().walk("back"), "--t-p", "0.5"}, more));
}

void copy_database(const fs::path& from, const fs::path& to) {
  fs::remove_all(to);
  fs::copy(from, to);
}

/// The vocabulary, tree, and BOW matrices of the pretraining frames and places of a database.
std::array<fs::path, 4> openfabmap_files(const fs::path& path, const fs::path& folder) {
  const FabmapDatabase database = read_fabmap_database(path);
  const size_t words = database.tree.words();
  const auto matrix = [&](const std::string& name, const ViewWords& views) {
    std::vector<uint8_t> values(views.views() * words);
    for (size_t v = 0; v < views.views(); ++v)
      for (const uint32_t word : views.view(v)) values[v * words + word] = 1;
    write_array<uint8_t>(folder / name, values, {views.views(), words});
    return folder / name;
  };
  for (const char* name : {"vocabulary.npy", "tree.npy"}) fs::copy_file(path / name, folder / name);
  return {folder / "vocabulary.npy", folder / "tree.npy",
          matrix("bow-pretrain.npy", database.pretrain), matrix("bow-train.npy", database.views)};
}

RunOutcome import_openfabmap_files(const std::array<fs::path, 4>& files,
                                   const std::string& output) {
  return run_program("vpr-train", {"fabmap", "--from-openfabmap", "--features", "sift",
                                   "--vocabulary", files[0], "--tree", files[1], "--pretrain-bow",
                                   files[2], "--train-bow", files[3], "-o", output});
}

std::string without_last_bit(std::string text) {
  text.back() = static_cast<char>(text.back() ^ 1);
  return text;
}

}  // namespace

TEST_CASE("a FAB-MAP database is byte-identical for any number of threads and SIMD target") {
  const TemporaryFolder out;
  Words targets = simd_targets();
  for (const std::string& target : {targets.front(), targets.back()}) {
    fs::remove_all(out / "t.vprdb");
    run_ok("vpr-train",
           {"fabmap", "--pretrain", world().walk("other"), "--train", world().walk("one"),
            "--features", "sift", "--words", "60", "--threads", "1", "-o", out / "t.vprdb"},
           {"VPR_SIMD=" + target});
    for (const std::string& name : list_folder(world().fabmap())) {
      INFO(target << " " << name);
      CHECK(read_text(out / "t.vprdb" / name) == read_text(fs::path(world().fabmap()) / name));
    }
  }
}

TEST_CASE("adding views yields the database of training all together") {
  const TemporaryFolder out;
  ok(run_train(
      {"--train", world().walk("one"), "--train", world().walk("back"), "-o", out / "both.vprdb"}));
  run_ok("vpr-train",
         {"add", world().fabmap(), "--train", world().walk("back"), "-o", out / "added.vprdb"});
  for (const std::string& name : list_folder(out / "both.vprdb"))
    CHECK(read_text(out / "both.vprdb" / name) == read_text(out / "added.vprdb" / name));
}

TEST_CASE("a database imported from vocabulary, tree and words has the same posteriors") {
  const TemporaryFolder out;
  run_ok("vpr-train", {"fabmap", "--pretrain", world().walk("other"), "--train",
                       world().walk("one"), "--features", "sift", "--words", "60", "--clustering",
                       "radius", "--cluster-radius", "300", "-o", out / "r.vprdb"});
  const auto files = openfabmap_files(out / "r.vprdb", out.path());
  ok(import_openfabmap_files(files, out / "i.vprdb"));
  for (const std::string name : {"r", "i"})
    run_ok("vpr-query", {out / (name + ".vprdb"), "--query", world().walk("back"),
                         "--save-posteriors", out / (name + ".npy"), "--json"});
  CHECK(read_text(out / "r.npy") == read_text(out / "i.npy"));
}

TEST_CASE(
    "in vpr-query loops, a recording recognizes its own earlier frames, none within the gap") {
  const TemporaryFolder out;
  fs::create_directory(out / "lap");
  const Words names = images_of(world().walk("one"));
  for (size_t lap = 0; lap < 2; ++lap)
    for (size_t i = 0; i < names.size(); ++i)
      fs::copy(fs::path(world().walk("one")) / names[i],
               out / "lap" / (std::to_string(lap * names.size() + i) + ".png"));
  ok(run_train({"-o", out / "v.vprdb"}));
  check_failure("vpr-query", {out / "v.vprdb", "--query", out / "lap", "--json"}, 2,
                "vpr-query loops");
  run_ok("vpr-query", {"loops", out / "v.vprdb", "--query", out / "lap", "--gap", "20", "--t-p",
                       "0.2", "--save-posteriors", out / "p.npy", "-o", out / "r.json"});
  const auto rows = read_array<int32_t>(out / "r.best.npy");
  const auto lap = static_cast<int32_t>(names.size());
  size_t right = 0;
  for (int32_t frame = 0; frame < 2 * lap; ++frame) {
    const int32_t view = rows[static_cast<size_t>(4 * frame + 3)];
    REQUIRE(view < std::max(frame - 20, 0));
    if (frame >= lap && std::abs(view - (frame - lap)) <= 1) ++right;
  }
  CHECK(right > names.size() * 9 / 10);
  const NpyArray posteriors(out / "p.npy");
  REQUIRE(posteriors.shape() == std::vector<size_t>{2 * names.size(), 1 + 2 * names.size()});
  for (size_t frame = 0; frame < 2 * names.size(); ++frame) {
    double sum = 0;
    for (size_t i = 0; i <= 2 * names.size(); ++i)
      sum += posteriors.values<double>(2)[frame * (1 + 2 * names.size()) + i];
    REQUIRE(sum == Approx(1));
  }
}

TEST_CASE("an explanation lists words and draws them") {
  const TemporaryFolder out;
  const auto explain = [](const Words& more) {
    return run_program(
        "vpr-query",
        joined({"explain", world().fabmap(), "--query", world().walk("back"), "--frame"}, more));
  };
  const auto outcome = ok(explain({"20", "--train", world().walk("one"), "-o", out / "r.json"}));
  CHECK(has(outcome.out, "Frame 20:"));
  CHECK(read_text(out / "r.explain.png").substr(1, 3) == "PNG");
  const Json explanation = file_json(out / "r.json")["explanation"];
  REQUIRE(explanation["places"].size() == 3);
  for (const Json& place : explanation["places"]) {
    CHECK(place["for"][0]["log_odds"].get<double>() >= place["for"][1]["log_odds"].get<double>());
    CHECK(place["against"][0]["log_odds"].get<double>() < 0);
  }
  check_failure(explain({"999", "--json"}), 2, "--frame 999");
  check_failure(explain({"2", "--train", "none=x", "-o", out / "s.json"}), 2, "none");
  check_failure("vpr-query", {"explain", world().database(), "--query", "q", "--frame", "2"}, 4,
                "vpr-query explain");
  CHECK(!fs::exists(out / "s.json"));
}

TEST_CASE("a frame without features keeps its index; a vocabulary needs some features") {
  const TemporaryFolder out;
  fs::create_directory(out / "gray");
  for (const char* name : {"1.pgm", "2.pgm"}) write_text(out / "gray" / name, kGrayImage);
  check_failure(
      "vpr-train",
      {"fabmap", "--pretrain", out / "gray", "--train", world().walk("one"), "-o", out / "x.vprdb"},
      2, "none of the 2 --pretrain frames has a surf feature");
  check_failure(
      "vpr-train",
      {"fabmap", "--pretrain", out / "gray", "--clustering", "radius", "-o", out / "x.vprdb"}, 2,
      "larger images, or another kind of --features");
  run_ok("vpr-query", {world().fabmap(), "--query", out / "gray", "-o", out / "r.json"});
  const NpyArray best(out / "r.best.npy");
  CHECK(best.shape()[0] == 2);
  CHECK(best.values<int32_t>(2)[1] == -1);
}

TEST_CASE("frames without features are counted, with a warning about their share") {
  const TemporaryFolder out;
  fs::copy(world().walk("one"), out / "walk");
  const auto frames = list_folder(out / "walk").size();
  for (size_t i = 0; i < frames; ++i)
    write_text(out / "walk" / fmt::format("zz{}.pgm", i), kGrayImage);
  const auto query =
      run_ok("vpr-query", {world().fabmap(), "--query", out / "walk", "-o", out / "r.json"});
  CHECK(has(query.err, "have no sift features"));
  CHECK(has(query.out, fmt::format("{} frames without features", frames)));
  CHECK(file_json(out / "r.json")["query"]["featureless"] == frames);
  const auto trained = ok(run_train({"--train", out / "walk", "-o", out / "w.vprdb", "--json"}));
  CHECK(has(trained.err, "larger images"));
  CHECK(Json::parse(trained.out)["featureless_views"] == frames);
  CHECK(run_query({"--json"}).err.empty());
}

TEST_CASE(
    "a query without recognitions states the highest probability, but suggests no smaller t_p") {
  const auto nothing =
      run_ok("vpr-query", {world().fabmap(), "--query", world().walk("back"), "--t-p", "0.9999"});
  INFO(nothing.out);
  CHECK(has(nothing.out, "no probability is above t_p 0.9999. The highest is 0."));
  CHECK_FALSE(has(nothing.out, "--t-p"));
}

TEST_CASE("a flag of the other family is refused, and its counterpart is suggested") {
  check_failure(run_query({"--save-matrix", "m.npy", "--json"}), 2, "--save-posteriors");
  check_failure(run_query({"--t-r", "0.4", "--json"}), 2, "--t-p");
}

TEST_CASE("an undecodable frame never matches, as a view or in a loop") {
  const TemporaryFolder out;
  fs::copy(world().walk("one"), out / "one");
  const std::string broken = list_folder(out / "one")[3];
  write_text(out / "one" / broken, "broken");
  ok(run_train({"--train", out / "one", "--skip-unreadable", "-o", out / "b.vprdb"}));
  fs::create_directory(out / "gray");
  write_text(out / "gray/1.pgm", kGrayImage);
  run_ok("vpr-query", {out / "b.vprdb", "--query", out / "gray", "--save-posteriors", out / "p.npy",
                       "-o", out / "r.json"});
  const NpyArray posteriors(out / "p.npy");
  const double floor = 0.01 / static_cast<double>(posteriors.shape()[1]);
  CHECK(posteriors.values<double>(2)[1 + 3] == Approx(floor));
  // A gray frame after the broken one, which resembles no other frame.
  fs::copy(out / "gray/1.pgm", out / "one/zz.pgm");
  ok(run_train({"-o", out / "v.vprdb"}));
  run_ok("vpr-query", {"loops", out / "v.vprdb", "--query", out / "one", "--skip-unreadable",
                       "--t-p", "0.5", "-o", out / "l.json"});
  const NpyArray recognitions(out / "l.recognitions.npy");
  for (size_t i = 0; i < recognitions.shape()[0]; ++i)
    CHECK(recognitions.values<int32_t>(2)[4 * i + 3] != 3);
}

TEST_CASE("a FAB-MAP database does not depend on the instruction sets that OpenCV finds") {
  const std::string features = GENERATE(as<std::string>(), "sift", "kaze", "akaze", "orb");
  const TemporaryFolder out;
  for (const std::string disabled :
       {"", "AVX2,AVX512-SKX", "SSE4.1,SSE4.2,FP16,AVX,AVX2,AVX512-SKX"})
    run_ok(
        "vpr-train",
        {"fabmap", "--pretrain", world().walk("other") + "@0:8", "--features", features, "--words",
         "20", "--train", world().walk("one") + "@0:8", "-o", out / ("without " + disabled)},
        {"OPENCV_CPU_DISABLE=" + disabled});
  for (const std::string& name : list_folder(out / "without "))
    for (const std::string& other : list_folder(out.path()))
      CHECK(read_text(out / "without " / name) == read_text(out / other / name));
}

TEST_CASE("an undecodable pretraining frame is omitted and is not a frame without words") {
  const TemporaryFolder out;
  fs::copy(world().walk("other"), out / "broken");
  write_text(out / "broken/00001a.jpg", "broken");
  for (const std::string& folder : {world().walk("other"), (out / "broken").string()})
    run_ok("vpr-train", {"fabmap", "--pretrain", folder, "--features", "orb", "--words", "40",
                         "--train", world().walk("one"), "--skip-unreadable", "-o",
                         out / (fs::path(folder).filename().string() + ".vprdb")});
  for (const std::string& name : list_folder(out / "other.vprdb"))
    CHECK(read_text(out / "other.vprdb" / name) == read_text(out / "broken.vprdb" / name));
}

TEST_CASE("FAB-MAP settings out of range are refused") {
  using Wrong = std::vector<std::array<std::string, 3>>;  // flag, value, a word of the message
  const TemporaryFolder out;
  for (const auto& [flag, value, word] : Wrong{{"--t-p", "1.5", "t_p must be"},
                                               {"--t-p", "nan", "\"--t-p\""},
                                               {"--c-w", "0", "c_w must be"},
                                               {"--c-w", "-1", "\"--c-w\""},
                                               {"--variant", "fabmap3", "did you mean fabmap2?"},
                                               {"--word-model", "x", "\"--word-model\""},
                                               {"--new-place", "never", "\"--new-place\""}})
    check_failure("vpr-query",
                  {world().fabmap(), "--query", world().walk("back"), flag, value, "--json"}, 2,
                  word);
  for (const auto& [flag, value, word] : Wrong{{"--words", "0", "from 2 to 10000000"},
                                               {"--words", "1", "from 2 to 10000000"},
                                               {"--words", "100000000", "from 2 to 10000000"},
                                               {"--features", "surff", "\"--features\""},
                                               {"--words", "999999", "use fewer --words"},
                                               {"--place", "x", "NAME=SEQUENCE"},
                                               {"--clustering", "tree", "\"--clustering\""}})
    check_failure("vpr-train",
                  {"fabmap", "--pretrain", world().walk("other"), "--train", world().walk("one"),
                   flag, value, "-o", out / "x.vprdb"},
                  2, word);
  for (const Words& words : {Words{"--tree", "t.npy"}, Words{"--from-openfabmap"}})
    check_failure(run_train(joined(words, {"-o", out / "x.vprdb"})), 2, "--from-openfabmap");
  CHECK(list_folder(out.path()).empty());
}

TEST_CASE("damage in any file of a FAB-MAP database is detected") {
  const TemporaryFolder out;
  const fs::path broken = out / "d.vprdb";
  for (const std::string& name : list_folder(world().fabmap())) {
    INFO(name);
    const std::string whole = read_text(fs::path(world().fabmap()) / name);
    for (const std::string& text :
         {without_last_bit(whole), whole.substr(0, whole.size() / 2), std::string()}) {
      copy_database(world().fabmap(), broken);
      write_text(broken / name, text);
      check_failure("vpr-train", {"info", broken}, 4, "d.vprdb");
      check_failure("vpr-query", {broken, "--query", world().walk("back"), "--json"}, 4, "d.vprdb");
    }
    copy_database(world().fabmap(), broken);
    fs::remove(broken / name);
    const int exit_code = run_program("vpr-train", {"info", broken}).exit_code;
    CHECK((exit_code == 3 || exit_code == 4));
  }
}

TEST_CASE("damage in any file of a FAB-MAP result is detected") {
  const TemporaryFolder out;
  ok(run_query({"-o", out / "r.json"}));
  const auto eval = [&] {
    return run_program("vpr-eval", {out / "r.json", "--ground-truth", "aligned"});
  };
  ok(eval());
  for (const std::string name : {"r.json", "r.recognitions.npy", "r.recognition_scores.npy",
                                 "r.best.npy", "r.best_scores.npy", "r.new_place.npy"}) {
    INFO(name);
    const std::string whole = read_text(out / name);
    for (const std::string& text :
         {whole.substr(0, whole.size() / 2), without_last_bit(whole), std::string()}) {
      write_text(out / name, text);
      // The last byte of a JSON file is a line feed, which another byte may replace.
      if (name != "r.json" || text.size() < whole.size()) check_failure(eval(), 4, "r.");
    }
    write_text(out / name, whole);
  }
}

TEST_CASE("FAB-MAP with places and FastABLE with frames are compared query by query") {
  const TemporaryFolder out;
  const std::string walk = world().walk("one");
  const size_t frames = images_of(walk).size();
  const size_t half = frames / 2;
  ok(run_train({"--place", fmt::format("a={}@0:{}", walk, half), "--place",
                fmt::format("b={}@{}:{}", walk, half, frames), "-o", out / "p.vprdb"}));
  run_ok("vpr-train", {"fastable", "--train", walk, "--c-l", "4", "-o", out / "s.vprdb"});
  run_ok("vpr-query", {out / "p.vprdb", "--query", walk, "-o", out / "p.json"});
  run_ok("vpr-query",
         {out / "s.vprdb", "--query", walk, "--c-l", "4", "--t-r", "0.3", "-o", out / "s.json"});
  const Json result = file_json(out / "p.json");
  CHECK(result["sequences"][0]["frames"] == 2);
  CHECK(result["places"]["names"] == Json{"a", "b"});
  CHECK(result["places"]["views"] == frames);
  // Frames of the last place without a label in the ground truth of places.
  const auto compare = [&](size_t unknown) {
    std::string pairs = "query,reference\n";
    for (size_t frame = 0; frame + unknown < frames; ++frame)
      pairs += fmt::format("{},{}\n", frame, frame < half ? 0 : 1);
    write_text(out / "places.csv", pairs);
    const auto evaluate = [&](const std::string& name, const std::string& truth) {
      run_ok("vpr-eval", {out / (name + ".json"), "--ground-truth", truth, "--force", "-o",
                          out / (name + "-report.json")});
    };
    evaluate("p", out / "places.csv");
    evaluate("s", "aligned");
    const auto run =
        run_ok("vpr-eval", {"compare", out / "p-report.json", out / "s-report.json", "--json"});
    CHECK(has(run.err, "places and frames have different ground truths"));
    return Json::parse(run.out);
  };
  const Json all = compare(0);
  CHECK(all["ground_truths"] == "of-places-and-frames");
  CHECK(all["frames"]["compared"] == frames);
  CHECK(all["frames"]["with_match"] == frames);
  CHECK(all["frames"]["disputed"] == 0);
  // A sequence against itself: both methods have every frame correct at which a window ends.
  CHECK(all["paired"][0]["both_correct"] == frames - 3);
  const Json fewer = compare(5);
  CHECK(fewer["frames"]["compared"] == frames - 5);
  CHECK(fewer["frames"]["disputed"] == 5);
}

TEST_CASE("damaged OpenFABMAP files are refused") {
  const TemporaryFolder out;
  const auto files = openfabmap_files(world().fabmap(), out.path());
  for (const fs::path& file : files) {
    INFO(file);
    const std::string whole = read_text(file);
    for (const std::string& text :
         {whole.substr(0, whole.size() / 2), std::string("x: 3\n"), std::string()}) {
      write_text(file, text);
      check_failure(import_openfabmap_files(files, out / "x.vprdb"), 4, file.filename().string());
    }
    fs::remove(file);
    CHECK(import_openfabmap_files(files, out / "x.vprdb").exit_code == 3);
    write_text(file, whole);
  }
  CHECK(!fs::exists(out / "x.vprdb"));
}
