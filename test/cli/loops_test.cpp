// vpr-eval loops and vpr-query loops.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;

namespace {

// Three laps of a square of 40 frames, one second and one meter apart, and a list of loops.
void make_laps() {
  std::string text;
  for (int frame = 0; frame < 120; ++frame) {
    const int at = frame % 40;
    const int x = at < 10 ? at : at < 20 ? 10 : at < 30 ? 30 - at : 0;
    const int y = at < 10 ? 0 : at < 20 ? at - 10 : at < 30 ? 10 : 40 - at;
    text += fmt::format("{} {} {} 0 0 0 0 1\n", 100 + frame, x, y);
  }
  write_text("laps.txt", text);
  write_text("closures.csv", "query,match,score\n50,10,0.9\n70,5,0.6\n90,10,0.5\n50,49,0.4\n");
}

const std::string kJudge = "vpr-eval loops closures.csv --poses laps.txt ";

// Two laps of the same 20 rendered frames, and then others; the names of frames are times, half a
// second apart.
void make_rendered_laps() {
  std::filesystem::create_directory("walk");
  std::string text = "frame,x,y\n";
  for (int f = 0; f < 50; ++f) {
    const int shown = f < 40 ? f % 20 : f - 20;
    std::filesystem::copy_file(fmt::format("{}/{:05}.png", world().walk("one"), shown),
                               fmt::format("walk/{}.{}.png", 100 + f / 2, f % 2 * 5));
    text += fmt::format("{},{},0\n", f, shown);
  }
  write_text("poses.csv", text);
}

const std::string kLoops = "vpr-query loops --query walk --c-l 4 --force ";

Json judge(const std::string& words) {
  return printed_json("vpr-eval loops --poses poses.csv --radius 0.5 --gap 15 --json " + words);
}

}  // namespace

TEST_CASE("a list of loop closures is evaluated by its trajectory, and drawn on it") {
  start_with(make_laps);
  const auto outcome = run_ok(
      kJudge + "--radius 0.5 --gap 30s --similarity --json --plot plots --html p.html -o r.json");
  CHECK(outcome.err.empty());
  const Json report = Json::parse(outcome.out);
  CHECK(report["schema"] == "vpr.loops/3");
  CHECK(report["name"] == "closures");
  CHECK(report["loops"]["correct"] == 2);
  CHECK(report["loops"]["incorrect"] == 1);
  CHECK(report["loops"]["too_near"] == 1);
  CHECK(report["loops"]["precision"].get<double>() == Approx(2 / 3.0));
  CHECK(report["frames"]["with_loop"] == 80);
  CHECK(report["frames"]["found"] == 2);
  CHECK(report["frames"]["longest_missed"] == Json{{"first", 51}, {"last", 89}});
  CHECK(report["revisits"]["count"] == 1);
  CHECK(report["revisits"]["missed"].empty());
  REQUIRE(report["incorrect_loops"].size() == 1);
  CHECK(report["incorrect_loops"][0]["line"] == 3);
  CHECK(report["incorrect_loops"][0]["query"] == 70);
  CHECK(report["metrics"]["recall_at_100_precision"].get<double>() == Approx(1 / 80.0));
  CHECK(report["trajectory"]["duration_s"] == 119);
  CHECK(list_folder("plots") == Words{".vpr-files", "loops.pdf", "loops.png", "loops.svg",
                                      "precision-recall.pdf", "precision-recall.png",
                                      "precision-recall.svg"});
  const std::string page = read_text("p.html");
  CHECK(has(page,
            "1 of 3 loops are incorrect. 2 of 80 frames near an earlier one have a correct loop"));
  CHECK(has(page, "line 3: frame 70 at frame 5"));
  CHECK(has(page, "frame with a correct loop"));
  CHECK_FALSE(has(page, "{{"));
  CHECK(has(read_text("plots/loops.svg"), "incorrect loop"));
}

TEST_CASE("a list without scores has no curve, and its table lists the incorrect loops") {
  start_with(make_laps);
  write_text("closures.csv", "170 130\n170.0 105\n");
  const std::string brief = run_ok(kJudge + "--radius 1 --gap 20 --name mine").out;
  CHECK(has(brief, "1 of 2 loops are incorrect."));
  CHECK(has(brief, "line 2: frame 70 at frame 5, 11.18 m away"));
  for (const std::string word : {"mine (within", "R@100P"}) CHECK_FALSE(has(brief, word));
  CHECK(has(run_ok(kJudge + "--radius 1 --gap 20 --name mine -v").out,
            "mine (within 1.0 m, 20 frames apart)"));
}

TEST_CASE("a sequence against its own past yields loops for vpr-eval") {
  start_with(make_rendered_laps);
  for (const std::string score : {"raw", "zscore"}) {
    INFO(score);
    run_ok(kLoops + "--gap 15 -o r.json --save-loops loops.csv --score " + score);
    const Json by_result = judge("r.json");
    const Json by_list = judge("loops.csv --distance");
    for (const std::string part : {"loops", "metrics", "incorrect_loops"})
      CHECK(by_list[part] == by_result[part]);
    // Windows of the second lap match the first lap, except those that begin in the first lap and
    // end in the second, which resemble none.
    CHECK(by_result["loops"]["listed"] == 50 - 3 - 15);
    CHECK(by_result["loops"]["too_near"] == 0);
    CHECK(by_result["frames"]["with_loop"] == 20);
    CHECK(by_result["frames"]["found"].get<int>() >= 17);
  }
  CHECK(run_ok(kLoops + "--gap 15").out.starts_with("Matched 32 of 50 frames of walk.\n"));
  // The identical frames of the second lap have distance 0.
  const std::string identical = kLoops + "--gap 15 --t-r 1 --save-loops loops.csv -o r.json --json";
  CHECK(printed_json(identical)["totals"]["recognitions"] == 17);
  const Json right = judge("loops.csv --distance");
  CHECK(right["loops"]["listed"] == 17);
  CHECK(right["loops"]["incorrect"] == 0);
  // The settings of a result repeat the query.
  run_ok("vpr-query loops --query walk --config r.json --save-loops again.csv");
  CHECK(read_text("again.csv") == read_text("loops.csv"));
}

TEST_CASE("a gap in seconds uses the names of frames, or times") {
  start_with(make_rendered_laps);
  std::string times;
  for (int f = 0; f < 50; ++f) times += fmt::format("{}\n", 7 + 0.5 * f);
  write_text("times.txt", times);
  const auto loops = [](const std::string& gap) {
    run_ok(kLoops + "--save-loops loops.csv --gap " + gap);
    return read_text("loops.csv");
  };
  const std::string frames = loops("15");
  CHECK(loops("7.5s") == frames);
  CHECK(loops("7.5s --frame-times times.txt") == frames);
  // Names that may be frame numbers are used as times, with a message.
  const auto counted = run_ok("vpr-query loops --gap 15s --c-l 4 --query $one");
  CHECK(has(counted.err, "if they count frames"));
}

TEST_CASE("FAB-MAP's own frames are loops as well") {
  start_with(make_rendered_laps);
  run_ok("vpr-query loops $fabmap --query walk --gap 14 --save-loops loops.csv -o r.json");
  const Json by_result = judge("r.json");
  CHECK(judge("loops.csv --similarity")["loops"] == by_result["loops"]);
  CHECK(by_result["loops"]["too_near"] == 0);
}

TEST_CASE("an image and a matrix of a sequence against its past show the compared frames") {
  start_with(make_rendered_laps);
  run_ok(kLoops + "--gap 15 --save-matrix m.npy");
  REQUIRE(NpyArray("m.npy").shape() == std::vector<size_t>{47, 47});
  const auto values = read_array<int32_t>("m.npy");
  for (size_t j = 0; j < 47; ++j)
    for (size_t i = 0; i < 47; ++i) CHECK((values[j * 47 + i] == -1) == (i + 15 > j));
  run_ok(kLoops + "--gap 15 --save-matrix m.png");
}
