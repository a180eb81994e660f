// vpr-eval loops and vpr-query --loop.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;

namespace {

/// Three laps of a square of 40 frames, one second and one meter apart.
struct Laps {
  TemporaryFolder folder;
  std::string poses = folder / "laps.txt";
  std::string loops = folder / "closures.csv";

  Laps() {
    std::string text;
    for (int frame = 0; frame < 120; ++frame) {
      const int at = frame % 40;
      const int x = at < 10 ? at : at < 20 ? 10 : at < 30 ? 30 - at : 0;
      const int y = at < 10 ? 0 : at < 20 ? at - 10 : at < 30 ? 10 : 40 - at;
      text += fmt::format("{} {} {} 0 0 0 0 1\n", 100 + frame, x, y);
    }
    write_text(poses, text);
    write_text(loops, "query,match,score\n50,10,0.9\n70,5,0.6\n90,10,0.5\n50,49,0.4\n");
  }

  RunOutcome run(Words more) const {
    return run_program("vpr-eval", joined({"loops", loops, "--poses", poses}, more));
  }
};

}  // namespace

TEST_CASE("a list of loop closures is evaluated by its trajectory, and drawn on it") {
  const Laps laps;
  const std::string plots = laps.folder / "plots";
  const auto run =
      laps.run({"--radius", "0.5", "--gap", "30s", "--similarity", "--json", "--plot", plots,
                "--html", laps.folder / "p.html", "-o", laps.folder / "r.json"});
  CHECK(run.err.empty());
  REQUIRE(run.exit_code == 0);
  const Json report = Json::parse(run.out);
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
  CHECK(list_folder(plots) == Words{".vpr-files", "loops.png", "loops.svg", "precision-recall.png",
                                    "precision-recall.svg"});
  const std::string page = read_text(laps.folder / "p.html");
  CHECK(has(page,
            "1 of 3 loops are incorrect. 2 of 80 frames near an earlier one have a correct loop"));
  CHECK(has(page, "line 3: frame 70 at frame 5"));
  CHECK(has(page, "frame with a correct loop"));
  CHECK_FALSE(has(page, "{{"));
  CHECK(has(read_text(plots + "/loops.svg"), "incorrect loop"));
}

TEST_CASE("a list without scores has no curve, and its table lists the incorrect loops") {
  const Laps laps;
  write_text(laps.loops, "170 130\n170.0 105\n");
  const auto run = ok(laps.run({"--radius", "1", "--gap", "20", "--name", "mine"}));
  CHECK(has(run.out, "1 of 2 loops are incorrect."));
  CHECK(has(run.out, "line 2: frame 70 at frame 5, 11.18 m away"));
  CHECK_FALSE(has(run.out, "mine (within"));
  CHECK(has(ok(laps.run({"--radius", "1", "--gap", "20", "--name", "mine", "-v"})).out,
            "mine (within 1.0 m, 20 frames apart)"));
  CHECK_FALSE(has(run.out, "R@100P"));
}

TEST_CASE("loops reports missing inputs, and refuses invalid lists with file and line") {
  const Laps laps;
  const auto refused = [&](const Words& words, int code, const char* sentence) {
    const auto run = laps.run(words);
    CHECK(run.exit_code == code);
    INFO(run.err);
    CHECK(has(run.err, sentence));
  };
  refused({"--gap", "3", "--similarity"}, 2, "--radius is required");
  refused({"--radius", "1", "--similarity"}, 2, "--gap is required");
  refused({"--radius", "1", "--gap", "soon"}, 2, "--gap 300");
  refused({"--radius", "1", "--gap", "3"}, 2, "--similarity (higher is better)");
  refused({"--radius", "1", "--gap", "3", "--ground-truth", "aligned"}, 2, "not expected");
  for (const char* number : {"nan", "inf", "-1"}) {
    refused({"--radius", number, "--gap", "3", "--similarity"}, 2, "at least 0");
    refused({"--radius", "1", "--gap", "3", "--similarity", "--max-difference", number}, 2,
            "0 to 1e9 seconds");
  }
  write_text(laps.loops, "30,2\n2,30\n");
  refused({"--radius", "1", "--gap", "3"}, 4, "closures.csv, line 2: frame 2 closes a loop");
  write_text(laps.loops, "30,2\n300,2\n");
  refused({"--radius", "1", "--gap", "3"}, 4, "closures.csv, line 2: there is no frame 300");
  CHECK(has(run_program("vpr-eval", {"loops", laps.loops, "--radius", "1", "--gap", "3"}).err,
            "--poses is required"));
}

namespace {

/// Two laps of the same 20 rendered frames, and then others; the names of frames are times, half a
/// second apart.
struct RenderedLaps {
  TemporaryFolder folder;
  std::string frames = folder / "walk";
  std::string poses = folder / "poses.csv";
  std::string result = folder / "r.json";

  RenderedLaps() {
    namespace fs = std::filesystem;
    fs::create_directory(frames);
    std::string text = "frame,x,y\n";
    for (int f = 0; f < 50; ++f) {
      const int shown = f < 40 ? f % 20 : f - 20;
      fs::copy_file(fmt::format("{}/{:05}.png", world().walk("one"), shown),
                    fmt::format("{}/{}.{}.png", frames, 100 + f / 2, f % 2 * 5));
      text += fmt::format("{},{},0\n", f, shown);
    }
    write_text(poses, text);
  }

  RunOutcome query(Words more) const {
    return run_program("vpr-query",
                       joined({"loops", "--query", frames, "--c-l", "4", "--force"}, more));
  }
  Json judge(const std::string& list, Words more) const {
    return printed_json("vpr-eval", joined({"loops", list, "--poses", poses, "--radius", "0.5",
                                            "--gap", "15", "--json"},
                                           more));
  }
};

}  // namespace

TEST_CASE("a sequence against its own past yields loops for vpr-eval") {
  const RenderedLaps laps;
  const std::string list = laps.folder / "loops.csv";
  for (const char* score : {"raw", "zscore"}) {
    INFO(score);
    ok(laps.query({"--gap", "15", "--score", score, "-o", laps.result, "--save-loops", list}));
    const Json by_result = laps.judge(laps.result, {});
    const Json by_list = laps.judge(list, {"--distance"});
    CHECK(run_program("vpr-eval", {"loops", laps.result, "--poses", laps.poses, "--radius", "0.5",
                                   "--gap", "15", "--distance"})
              .exit_code == 2);
    CHECK(by_list["loops"] == by_result["loops"]);
    CHECK(by_list["metrics"] == by_result["metrics"]);
    CHECK(by_list["incorrect_loops"] == by_result["incorrect_loops"]);
    // Windows of the second lap match the first lap, except those that begin in the first lap and
    // end in the second, which resemble none.
    CHECK(by_result["loops"]["listed"] == 50 - 3 - 15);
    CHECK(by_result["frames"]["with_loop"] == 20);
    CHECK(by_result["frames"]["found"].get<int>() >= 17);
    CHECK(by_result["loops"]["too_near"] == 0);
  }
  // The identical frames of the second lap have distance 0.
  CHECK(printed_json(laps.query({"--gap", "15", "--t-r", "1", "--save-loops", list, "-o",
                                 laps.result, "--json"}))["totals"]["recognitions"] == 17);
  const Json right = laps.judge(list, {"--distance"});
  CHECK(right["loops"]["listed"] == 17);
  CHECK(right["loops"]["incorrect"] == 0);
  // The settings of a result repeat the query.
  const auto again = run_ok("vpr-query", {"loops", "--query", laps.frames, "--config", laps.result,
                                          "--save-loops", laps.folder / "again.csv"});
  CHECK(read_text(laps.folder / "again.csv") == read_text(list));
}

TEST_CASE("a gap in seconds uses the names of frames, or times") {
  const RenderedLaps laps;
  const std::string frames = laps.folder / "frames.csv";
  const std::string seconds = laps.folder / "seconds.csv";
  const std::string listed = laps.folder / "listed.csv";
  const std::string times = laps.folder / "times.txt";
  std::string text;
  for (int f = 0; f < 50; ++f) text += fmt::format("{}\n", 7 + 0.5 * f);
  write_text(times, text);
  ok(laps.query({"--gap", "15", "--save-loops", frames}));
  ok(laps.query({"--gap", "7.5s", "--save-loops", seconds}));
  ok(laps.query({"--gap", "7.5s", "--frame-times", times, "--save-loops", listed}));
  CHECK(read_text(seconds) == read_text(frames));
  CHECK(read_text(listed) == read_text(frames));
  write_text(times, "1\n2\n3\n");
  check_failure(laps.query({"--gap", "7.5s", "--frame-times", times}), 4, "3 times");
  // Names that may be frame numbers are used as times, with a message.
  const auto counted =
      run_ok("vpr-query", {"loops", "--gap", "15s", "--c-l", "4", "--query", world().walk("one")});
  CHECK(has(counted.err, "if they count frames"));
}

TEST_CASE("loops without a database refuse incompatible flags") {
  const RenderedLaps laps;
  const auto refused = [&](Words words, const char* word) {
    INFO(word);
    check_failure(laps.query(joined({"--gap", "15"}, words)), 2, word);
  };
  check_failure(laps.query({}), 2, "--gap 300");
  check_failure(laps.query({"--gap", "soon"}), 2, "--gap");
  refused({world().database()}, "DB does not go with vpr-query loops");
  refused({"--speed", "2"}, "--speed");
  refused({"--method", "filter"}, "--method");
  refused({"--rates", "1,2"}, "--rates");
  refused({"--score", "zscore-offline"}, "later frames");
  refused({"--t-r", "0.5", "--t-r-scale", "relative"}, "relative");
  refused({"--decide", "margin"}, "--margin");
  refused({"--frame-times", laps.poses}, "30s");
  refused({"--descriptor", "ldp"}, "ldb");
  refused({"--c-l", "51"}, "--c-l");
  const auto other = [&](Words words, const char* word) {
    INFO(word);
    check_failure("vpr-query", joined({world().database(), "--query", laps.frames}, words), 2,
                  word);
  };
  write_text(laps.folder / "hog.json", R"({"descriptor": "hog"})");
  other({"--config", laps.folder / "hog.json"}, "vpr-query loops");
  ok(laps.query({"--gap", "15", "-o", laps.result}));
  other({"--config", laps.result}, "has the settings of vpr-query loops");
  const auto fabmap = [&](Words words, const char* word) {
    INFO(word);
    check_failure("vpr-query", joined({"loops", world().fabmap(), "--query", laps.frames}, words),
                  2, word);
  };
  fabmap({"--gap", "30s"}, "frames");
  fabmap({"--gap", "-1"}, "\"--gap\"");
  fabmap({"--gap", "30", "--frame-times", laps.poses}, "30s");
  fabmap({"--descriptor", "hog"}, "no effect with a database for fabmap");
}

TEST_CASE("FAB-MAP's own frames are loops as well") {
  const RenderedLaps laps;
  const std::string list = laps.folder / "loops.csv";
  run_ok("vpr-query", {"loops", world().fabmap(), "--query", laps.frames, "--gap", "14",
                       "--save-loops", list, "-o", laps.result});
  const Json by_result = laps.judge(laps.result, {});
  CHECK(laps.judge(list, {"--similarity"})["loops"] == by_result["loops"]);
  CHECK(by_result["loops"]["too_near"] == 0);
}

TEST_CASE("an image and a matrix of a sequence against its past show the compared frames") {
  const RenderedLaps laps;
  const std::string matrix = laps.folder / "m.npy";
  ok(laps.query({"--gap", "15", "--save-matrix", matrix}));
  const NpyArray cells(matrix);
  REQUIRE(cells.shape() == std::vector<size_t>{47, 47});
  const auto values = cells.values<int32_t>(2);
  for (size_t j = 0; j < 47; ++j)
    for (size_t i = 0; i < 47; ++i) CHECK((values[j * 47 + i] == -1) == (i + 15 > j));
  ok(laps.query({"--gap", "15", "--save-matrix", laps.folder / "m.png"}));
}

TEST_CASE("loops of a sequence are the same for any threads and any SIMD target") {
  const RenderedLaps laps;
  std::string expected;
  for (const char* threads : {"1", "3"})
    for (const std::string& target : simd_targets()) {
      const std::string list = laps.folder / "loops.csv";
      run_ok("vpr-query",
             {"loops", "--query", laps.frames, "--c-l", "4", "--gap", "15", "--score", "zscore",
              "--threads", threads, "--save-loops", list, "--force"},
             {"VPR_SIMD=" + target});
      if (expected.empty()) expected = read_text(list);
      CHECK(read_text(list) == expected);
    }
}
