// Outputs of vpr-eval for other programs: expectations, XML and trajectories.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;

namespace {

/// Writes a result of the world's query.
void query_world(const std::string& name) {
  run_ok("vpr-query $db --dataset $dataset --t-r 0.3 --quiet --c-l 1 -o " + name);
}

const std::string kEval = "vpr-eval r.json --dataset $dataset ";

}  // namespace

TEST_CASE("a baseline is written, met, missed and updated") {
  query_world("r.json");
  check_failure(kEval + "--expect baseline.json", 3, "Create it from this report with --update");
  run_ok(kEval + "--expect baseline.json --update");
  const auto met = run_ok(kEval + "--expect baseline.json");
  CHECK(has(met.out, "expected values are met."));
  write_text("baseline.json", R"({"schema": "vpr.expected/5",
      "best_match": {"rate": {"min": 2}, "frames": {"min": 1}}})");
  const auto missed = run(kEval + "--expect baseline.json --junit j.xml");
  CHECK(missed.exit_code == 5);
  CHECK(has(missed.err, "best_match.rate: expected at least 2, found "));
  CHECK(has(read_text("j.xml"), "tests=\"2\" failures=\"1\""));
  const auto updated = run_ok(kEval + "--expect baseline.json --update");
  CHECK(has(updated.out, "updated; 1 of 2 expected values were not met."));
  const Json kept = file_json("baseline.json");
  CHECK(kept["best_match"]["frames"]["min"] == 1);
  CHECK(kept["best_match"]["rate"]["min"].get<double>() <= 1);
  run_ok(kEval + "--expect baseline.json");
}

TEST_CASE(
    "recognitions are written from a trajectory with times, at another rate than the frames") {
  run_ok("vpr-query $db --query $one --c-l 1 --only-sequence one --t-r 0.3 -o r.json --quiet");
  // The sequence against itself: one meter per second up a slope, 4 poses and 2 frames per second.
  std::string poses;
  std::string times;
  const auto frames = static_cast<int>(images_of(world().walk("one")).size());
  for (int i = 0; i < 2 * frames; ++i)
    poses += fmt::format("{} {} 0 {} 0 0 0 1\n", 100 + 0.25 * i, 0.25 * i, 0.5 * i);
  std::string expected = "# time (s) x y z qx qy qz qw\n";
  for (int i = 0; i < frames; ++i) {
    times += fmt::format("{}\n", 100 + 0.5 * i);
    const std::string height = i == 0 ? "0" : fmt::format("{:.6f}", 1.0 * i);
    expected += fmt::format("{} {:.6f} 0.000000 {} 0 0 0 1\n", 100 + 0.5 * i, 0.5 * i, height);
  }
  write_text("poses.tum", poses);
  write_text("times.txt", times);
  run_ok(
      "vpr-eval r.json --ground-truth poses.tum --ground-truth-train poses.tum --radius 0.1 "
      "--query-times times.txt --train-times times.txt --save-trajectory f.txt");
  CHECK(read_text("f.txt") == expected);
  write_text("few.txt", "100\n");
  CHECK(run("vpr-eval r.json --ground-truth aligned --ground-truth-train poses.tum --query-times "
            "few.txt --save-trajectory g.txt")
            .exit_code != 0);
  query_world("of_dataset.json");
  run_ok("vpr-eval of_dataset.json --dataset $dataset --save-trajectory p.txt");
  CHECK(lines_of(read_text("p.txt")).size() > 5);
}

TEST_CASE("a method that answers few frames does not win by them") {
  // Ten frames: windows of 5 end at 6 frames and are all correct; single frames are correct in 9 of
  // 10.
  const auto report = [&](const std::string& name, size_t size, size_t mistakes,
                          const std::string& window) {
    std::vector<float> scores(size * size, 50);
    for (size_t q = 0; q < size; ++q) scores[q * size + (q < mistakes ? size - 1 : q)] = float(q);
    write_array((name + ".npy"), scores, {size, size});
    run_ok("vpr-eval matrix " + name + ".npy --distance --rows-are-windows-of " + window +
           " --ground-truth aligned -o " + name + ".json --quiet");
  };
  report("frames", 10, 1, "1");
  report("windows", 6, 0, "5");
  CHECK(file_json("windows.json")["localization"]["frames_with_match"] == 10);
  const std::string text = run_ok("vpr-eval compare frames.json windows.json").out;
  CHECK(text.starts_with("queries: over 10 frames with a match\n"));
  CHECK(has(text, "\nframes   0.9000 "));
  CHECK(has(text, "\nwindows  0.6000 "));
}
