// vpr-eval --loops as a user runs it.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "support.h"

using namespace vpr;
using test::run_program;

namespace {

/// Three laps of a square of 40 frames, a second and a metre apart.
struct Laps {
  test::TemporaryFolder folder;
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
    test::write_text(poses, text);
    test::write_text(loops, "query,match,score\n50,10,0.9\n70,5,0.6\n90,10,0.5\n50,49,0.4\n");
  }

  test::RunOutcome run(std::vector<std::string> more) const {
    more.insert(more.begin(), {"--loops", loops, "--poses", poses});
    return run_program("vpr-eval", more);
  }
};

}  // namespace

TEST_CASE("a list of loop closures is judged by its trajectory, and drawn on it") {
  const Laps laps;
  const std::string plots = laps.folder / "plots";
  const auto run =
      laps.run({"--radius", "0.5", "--gap", "30s", "--similarity", "--json", "--plot", plots,
                "--html", laps.folder / "p.html", "-o", laps.folder / "r.json"});
  CHECK(run.err.empty());
  REQUIRE(run.exit_code == 0);
  const Json report = Json::parse(run.out);
  CHECK(report["schema"] == "vpr.loops/1");
  CHECK(report["name"] == "closures");
  CHECK(report["loops"]["right"] == 2);
  CHECK(report["loops"]["wrong"] == 1);
  CHECK(report["loops"]["too_near"] == 1);
  CHECK(report["loops"]["precision"].get<double>() == Approx(2 / 3.0));
  CHECK(report["frames"]["with_loop"] == 80);
  CHECK(report["frames"]["found"] == 2);
  CHECK(report["frames"]["longest_missed"] == Json{{"first", 51}, {"last", 89}});
  CHECK(report["revisits"]["count"] == 1);
  CHECK(report["revisits"]["missed"].empty());
  REQUIRE(report["wrong_loops"].size() == 1);
  CHECK(report["wrong_loops"][0]["line"] == 3);
  CHECK(report["wrong_loops"][0]["query"] == 70);
  CHECK(report["metrics"]["recall_at_100_precision"].get<double>() == Approx(1 / 80.0));
  CHECK(report["trajectory"]["duration_s"] == 119);
  CHECK(test::list_folder(plots) == std::vector<std::string>{".vpr-files", "loops.png", "loops.svg",
                                                             "precision-recall.png",
                                                             "precision-recall.svg"});
  const std::string page = test::read_text(laps.folder / "p.html");
  CHECK(page.find("1 of 3 loops are wrong. 2 of 80 frames near an earlier one have a right loop") !=
        std::string::npos);
  CHECK(page.find("line 3: frame 70 at frame 5") != std::string::npos);
  CHECK(page.find("frame with a right loop") != std::string::npos);
  CHECK(page.find("{{") == std::string::npos);
  CHECK(test::read_text(plots + "/loops.svg").find("wrong loop") != std::string::npos);
}

TEST_CASE("a list without scores has no curve, and its table names what is wrong") {
  const Laps laps;
  test::write_text(laps.loops, "170 130\n170.0 105\n");
  const auto run = laps.run({"--radius", "1", "--gap", "20", "--name", "mine"});
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("1 of 2 loops are wrong.") != std::string::npos);
  CHECK(run.out.find("line 2: frame 70 at frame 5, 11.18 m away") != std::string::npos);
  CHECK(run.out.find("mine (within 1.0 m, 20 frames apart)") != std::string::npos);
  CHECK(run.out.find("R@100P") == std::string::npos);
}

TEST_CASE("--loops says what it needs, and refuses bad lists with file and line") {
  const Laps laps;
  const auto refused = [&](const std::vector<std::string>& words, int code, const char* sentence) {
    const auto run = laps.run(words);
    CHECK(run.exit_code == code);
    INFO(run.err);
    CHECK(run.err.find(sentence) != std::string::npos);
  };
  refused({"--gap", "3", "--similarity"}, 2, "--radius 2");
  refused({"--radius", "1", "--similarity"}, 2, "--gap 30s");
  refused({"--radius", "1", "--gap", "soon"}, 2, "--gap 300");
  refused({"--radius", "1", "--gap", "3"}, 2, "--similarity (large ones)");
  refused({"--radius", "1", "--gap", "3", "--ground-truth", "aligned"}, 2,
          "by its trajectory alone");
  const std::string out = laps.folder / "o";
  for (const auto& [flag, value] : {std::pair<std::string, std::string>("--offset", "1"),
                                    {"--angle", "5"},
                                    {"--tolerance", "3"},
                                    {"--junit", out},
                                    {"--pairs", out},
                                    {"--top-k", "3"},
                                    {"--query", "q"},
                                    {"--train", "t"},
                                    {"--confidence", "margin"}})
    refused({"--radius", "1", "--gap", "3", "--similarity", flag, value}, 2,
            "by its trajectory alone");
  refused({"--radius", "1", "--gap", "3", "--similarity", "--update"}, 2, "trajectory alone");
  refused({"--radius", "1", "--gap", "3", "--similarity", "--window", "3"}, 2, "with --scores");
  for (const char* number : {"nan", "inf", "-1"}) {
    refused({"--radius", number, "--gap", "3", "--similarity"}, 2, "0 or more");
    refused({"--radius", "1", "--gap", "3", "--similarity", "--max-difference", number}, 2,
            "0 to 1e9 seconds");
  }
  CHECK_FALSE(std::filesystem::exists(out));
  test::write_text(laps.loops, "30,2\n2,30\n");
  refused({"--radius", "1", "--gap", "3"}, 4, "closures.csv, line 2: frame 2 closes a loop");
  test::write_text(laps.loops, "30,2\n300,2\n");
  refused({"--radius", "1", "--gap", "3"}, 4, "closures.csv, line 2: there is no frame 300");
  CHECK(run_program("vpr-eval", {"--loops", laps.loops, "--radius", "1", "--gap", "3"})
            .err.find("--poses trajectory.txt") != std::string::npos);
  CHECK(run_program("vpr-eval", {"--gap", "3", "--ground-truth", "aligned"}).err.find("--loops") !=
        std::string::npos);
}
