// --fps and --speed: the selected and resampled frames, and their evaluation.
#include <algorithm>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"
#include "sequence/sequence.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

RunOutcome query(const std::string& database, const std::string& output, const Words& more) {
  return run_program("vpr-query", joined({database, "--t-r", "0.3", "-o", output}, more));
}

// The query "back" with single frames, so that results do not depend on neighboring frames.
RunOutcome single(const std::string& output, const Words& more) {
  return query(world().database(), output,
               joined({"--query", world().walk("back"), "--c-l", "1"}, more));
}

Json evaluate(const std::string& result, const Words& more = {}) {
  return printed_json("vpr-eval",
                      joined({result, "--ground-truth", world().truth("back"), "--json"}, more));
}

std::string outcomes(const Json& report) { return report["outcomes"]["best"].get<std::string>(); }

// Copies the frames of a sequence with times as names, `rate` per second, starting at `start_ms`.
void name_by_time(const std::string& walk, const fs::path& folder, int64_t start_ms,
                  int64_t interval_ms) {
  fs::create_directory(folder);
  for (const std::string& name : images_of(walk)) {
    fs::create_symlink(walk + "/" + name,
                       folder / fmt::format("{}.{:03}.png", start_ms / 1000, start_ms % 1000));
    start_ms += interval_ms;
  }
}

}  // namespace

TEST_CASE(
    "a resampled query has the results of the query frame by frame, with the same ground truth") {
  const TemporaryFolder out;
  ok(single(out / "plain.json", {}));
  const Json plain = evaluate(out / "plain.json");
  const std::string expected = outcomes(plain);
  ok(single(out / "thin.json", {"--recorded-fps", "30", "--fps", "10"}));
  const Json thin = evaluate(out / "thin.json");
  std::string kept;
  for (size_t i = 0; i < expected.size(); i += 3) kept += expected[i];
  CHECK(outcomes(thin) == kept);
  CHECK(thin["resampled"] == Json{{"fps", 10.0}, {"frames", expected.size()}});
  CHECK(has(thin["protocol"]["ground_truth"], ", query resampled to 10 frames per second"));
  const Json result = file_json(out / "thin.json");
  CHECK(result["query"]["fps"] == 10.0);
  CHECK(result["query"]["frames"] == kept.size());
  CHECK(read_array<int32_t>(out / "thin.source_frames.npy")[2] == 6);
  // Thinned, and then resampled.
  const auto both =
      ok(single(out / "both.json", {"--recorded-fps", "30", "--fps", "10", "--speed", "reversed"}));
  CHECK(has(both.out, "back, resampled to 10 frames per second, at speed reversed"));
  CHECK(outcomes(evaluate(out / "both.json")) == std::string(kept.rbegin(), kept.rend()));
  // The recording's own rate selects all frames.
  ok(single(out / "same.json", {"--recorded-fps", "30", "--fps", "30"}));
  CHECK(outcomes(evaluate(out / "same.json")) == expected);
  CHECK_FALSE(file_json(out / "same.json")["query"].contains("resampled"));
}

TEST_CASE("names, lists and constant rates select the same frames, live or not") {
  const TemporaryFolder out;
  const std::string walk = world().walk("back");
  const size_t frames = images_of(walk).size();
  name_by_time(walk, out / "named", 1305031102000, 100);
  std::string times = "time\n";
  for (size_t i = 0; i < frames; ++i) times += fmt::format("{}.{}\n", 70 + i / 10, i % 10);
  write_text(out / "times.csv", times);
  const auto run = [&](const std::string& name, const Words& more) {
    ok(query(world().database(), out / (name + ".json"),
             joined({"--c-l", "2", "--fps", "4"}, more)));
    return read_text(out / (name + ".source_frames.npy")) + read_text(out / (name + ".best.npy"));
  };
  const std::string even = run("even", {"--query", walk, "--recorded-fps", "10"});
  CHECK(run("named", {"--query", out / "named"}) == even);
  CHECK(run("list", {"--query", walk, "--query-times", out / "times.csv"}) == even);
  std::string list;
  for (const std::string& name : images_of(out / "named"))
    list += (out / "named/").string() + name + "\n";
  write_text(out / "list.txt", list);
  CHECK(run("list2", {"--query", out / "list.txt"}) == even);
  const Words live = {"live",    world().database(), "--c-l", "2",     "--t-r",
                      "200",     "--t-r-scale",      "bits",  "--fps", "4",
                      "--quiet", "--query"};
  const auto followed = run_ok("vpr-query", joined(live, {out / "list.txt"}));
  CHECK(static_cast<size_t>(std::count(followed.out.begin(), followed.out.end(), '\n')) ==
        NpyArray(out / "even.source_frames.npy").shape()[0]);
  CHECK(has(followed.out, "\"1305031102.200.png\""));
  CHECK_FALSE(has(followed.out, "\"1305031102.100.png\""));
  check_failure("vpr-query", joined(live, {walk, "--query-times", "t.csv"}), 2, "--query-times");
}

TEST_CASE("resampled training frames keep the ground truth of the recordings") {
  const TemporaryFolder out;
  const std::string database = out / "thin.vprdb";
  const Words train = {"fastable", "--train", world().walk("one"),
                       "--c-l",    "2",       "--recorded-fps",
                       "12",       "-o",      database};
  const auto trained = run_ok("vpr-train", joined(train, {"--fps", "4"}));
  const size_t recorded = images_of(world().walk("one")).size();
  const size_t kept = (recorded + 2) / 3;
  CHECK(has(trained.out, fmt::format("{} of {}", kept, recorded)));
  const auto info = run_program("vpr-train", {"info", database, "--json"});
  const Json sequence = printed_json(info)["sequences"][0];
  CHECK(sequence["fps"] == 4.0);
  CHECK(sequence["resampled"] == Json{{"fps", 4.0}, {"frames", recorded}});
  // A sequence against itself: frame i matches frame i of the recording, and the nearest selected
  // one.
  ok(query(database, out / "r.json", {"--query", world().walk("one"), "--c-l", "1"}));
  const Json report =
      printed_json("vpr-eval", {out / "r.json", "--ground-truth", "aligned", "--json"});
  CHECK(
      has(report["protocol"]["ground_truth"], "training frames resampled to 4 frames per second"));
  CHECK(report["best_match"]["without_match"] == 0);
  const std::string best = outcomes(report);
  for (size_t i = 0; i < best.size(); i += 3) CHECK(best[i] == 'c');
  // The selection changes with its file.
  write_text(out / "r.train_source_frames.npy", "no");
  CHECK(run_program("vpr-eval", {out / "r.json", "--ground-truth", "aligned"}).exit_code == 4);
}

TEST_CASE("two different rates cause a warning, unless the method estimates them") {
  const TemporaryFolder out;
  const std::string database = out / "w.vprdb";
  run_ok("vpr-train", {"fastable", "--train", world().walk("one"), "--c-l", "5", "--recorded-fps",
                       "8", "-o", database});
  const auto warned = [&](const Words& more) {
    const auto outcome =
        run_ok("vpr-query", joined({database, "--query", world().walk("back"), "-o", out / "r.json",
                                    "--force", "--c-l", "5", "--t-r", "0.5"},
                                   more));
    return outcome.err;
  };
  CHECK(has(warned({"--recorded-fps", "24"}),
            "the query has 24 frames per second, the training sequence one has 8"));
  CHECK(has(warned({"--recorded-fps", "24"}), "--fps 8 for the query, or --method filter"));
  CHECK(has(warned({"--recorded-fps", "4"}), "--fps 4 for vpr-train"));
  CHECK_FALSE(has(warned({"--recorded-fps", "24", "--fps", "8"}), "frames per second"));
  CHECK_FALSE(has(warned({"--recorded-fps", "8.5"}), "frames per second"));
  CHECK_FALSE(has(warned({}), "frames per second"));
  CHECK_FALSE(has(warned({"--recorded-fps", "24", "--rates", "1,1/3"}), "frames per second"));
  const auto filter =
      run_program("vpr-query", {database, "--query", world().walk("back"), "-o", out / "f.json",
                                "--method", "filter", "--recorded-fps", "24"});
  CHECK_FALSE(has(filter.err, "frames per second"));
}

TEST_CASE("missing rates and invalid times are refused with advice") {
  const TemporaryFolder out;
  const std::string walk = world().walk("back");
  const auto run = [&](const Words& more) {
    return query(world().database(), out / "r.json", joined({"--query", walk}, more));
  };
  check_failure(run({"--fps", "4"}), 2, "the times of its frames are unknown");
  check_failure(run({"--fps", "0", "--recorded-fps", "8"}), 2, "--fps must be above 0");
  check_failure(run({"--recorded-fps", "-1"}), 2, "--recorded-fps must be above 0");
  write_text(out / "falling.csv", "1\n2\n1.5\n");
  check_failure(run({"--fps", "4", "--query-times", out / "falling.csv"}), 4,
                "falling.csv, line 3");
  write_text(out / "repeated.csv", "1\n2\n2\n");
  check_failure(run({"--fps", "4", "--query-times", out / "repeated.csv"}), 4,
                "repeated.csv, line 3");
  write_text(out / "few.csv", "1\n2\n3\n");
  check_failure(run({"--fps", "4", "--query-times", out / "few.csv"}), 4, "has 3 times");
  check_failure(run({"--fps", "4", "--query-times", out / "none.csv"}), 3, "none.csv");
  // A single frame is selected at any rate.
  run_ok("vpr-query", {world().database(), "--query", walk + "@0:1", "--c-l", "1", "--t-r", "0.3",
                       "--fps", "4", "--recorded-fps", "30", "-o", out / "one.json"});
  check_failure("vpr-train",
                {"add", world().fabmap(), "--train", walk, "--fps", "2", "-o", out / "f.vprdb"}, 2,
                "does not support --fps");
}

TEST_CASE("a resampled query has the results of the query, frame by frame") {
  const TemporaryFolder out;
  ok(single(out / "plain.json", {}));
  const Json plain = evaluate(out / "plain.json");
  CHECK_FALSE(plain.contains("speed"));
  const std::string expected = outcomes(plain);
  for (const char* speed : {"0.5", "0.67", "1.5", "2", "0.9", "varying", "stops", "reversed"}) {
    INFO(speed);
    const std::string result = out / (std::string(speed) + ".json");
    ok(single(result, {"--speed", speed, "--seed", "3"}));
    const Json report = evaluate(result);
    const Selection shown = at_speed(speed, expected.size(), 3);
    CHECK(report["speed"] == Json{{"name", speed}, {"seed", 3}, {"frames", expected.size()}});
    CHECK(has(report["protocol"]["ground_truth"], "query at speed "));
    std::string replayed;
    for (const uint32_t source : shown.sources) replayed += expected[source];
    CHECK(outcomes(report) == replayed);
  }
  const Json kept = file_json(out / "varying.json");
  CHECK(kept["query"]["speed"]["name"] == "varying");
  CHECK(read_array<int32_t>(out / "varying.source_frames.npy").size() ==
        kept["query"]["frames"].get<size_t>());
}

TEST_CASE("a speed has the same bytes for any number of threads, and others for another seed") {
  const TemporaryFolder out;
  const auto bytes = [&](const std::string& name, const Words& more) {
    ok(single(out / (name + ".json"), joined({"--speed", "varying"}, more)));
    return read_text(out / (name + ".source_frames.npy")) + read_text(out / (name + ".best.npy"));
  };
  const std::string one = bytes("a", {"--threads", "1"});
  CHECK(bytes("b", {"--threads", "3"}) == one);
  CHECK(bytes("c", {"--seed", "2"}) != one);
  const auto at_speed = single(out / "d.json", {"--speed", "varying", "--seed", "7"});
  CHECK(has(at_speed.out, "back, at speed varying, seed 7"));
}

TEST_CASE("FAB-MAP also resamples a query") {
  const TemporaryFolder out;
  const auto run = [&](const std::string& name, const Words& more) {
    return run_program("vpr-query", joined({world().fabmap(), "--query", world().walk("back"),
                                            "--t-p", "0.5", "-o", out / name},
                                           more));
  };
  ok(run("plain.json", {}));
  const auto slowed = ok(run("slow.json", {"--speed", "0.5"}));
  CHECK(has(slowed.out, "back, at speed 0.5"));
  const auto best_of = [&](const char* name) {
    const auto values = read_array<int32_t>(out / name);
    std::vector<int32_t> places;
    for (size_t row = 0; row < values.size() / 4; ++row) places.push_back(values[4 * row + 2]);
    return places;
  };
  const std::vector<int32_t> plain = best_of("plain.best.npy");
  const std::vector<int32_t> slow = best_of("slow.best.npy");
  REQUIRE(slow.size() == 2 * plain.size());
  for (size_t k = 0; k < slow.size(); ++k) CHECK(slow[k] == plain[k / 2]);
}

TEST_CASE(
    "scores of a resampled query are evaluated like its result, and a sweep counts the same") {
  const TemporaryFolder out;
  ok(single(out / "r.json", {"--speed", "stops", "--seed", "5", "--only-sequence", "one",
                             "--save-matrix", out / "d.npy"}));
  const Json report = printed_json(
      "vpr-eval", {out / "r.json", "--ground-truth", "aligned", "--tolerance", "9", "--json"});
  const std::string frames = report["speed"]["frames"].dump();
  const auto judge = [&](const Words& more) {
    return run_program("vpr-eval", joined({"matrix", out / "d.npy", "--distance", "--json",
                                           "--ground-truth", "aligned", "--tolerance", "9"},
                                          more));
  };
  const Json scores =
      printed_json(judge({"--speed", "stops", "--seed", "5", "--query-frames", frames}));
  CHECK(outcomes(scores) == outcomes(report));
  CHECK(scores["speed"] == report["speed"]);
  check_failure(judge({"--speed", "stops", "--seed", "6", "--query-frames", frames}), 4,
                "Use the speed");
  check_failure(judge({"--speed", "stops"}), 2, "--query-frames");
  check_failure(judge({"--query-frames", frames}), 4, "need a query of 64 frames");
  check_failure(
      "vpr-eval",
      {out / "r.json", "--dataset", world().dataset(), "--speed", "2", "--query-frames", frames}, 2,
      "unknown flag --speed");

  const Json sweep = printed_json(
      "vpr-tune", {"fastable", world().database(), "--dataset", world().dataset(), "--c-l", "1,4",
                   "--t-r", "0.2,0.3", "--speed", "varying", "--json"});
  CHECK(sweep["queries"][0]["speed"]["name"] == "varying");
  ok(single(out / "v.json", {"--speed", "varying"}));
  const Json counts = evaluate(out / "v.json");
  CHECK(sweep["cells"][1]["counts"] == counts["counts"]);
  CHECK(sweep["cells"][1]["best_match"]["correct"] == counts["best_match"]["correct"]);
}

TEST_CASE("images and maps of a resampled query show the frames of the query") {
  const TemporaryFolder out;
  ok(single(out / "r.json", {"--speed", "reversed"}));
  run_ok("vpr-eval", {out / "r.json", "--dataset", world().dataset(), "--html", out / "r.html",
                      "--map", out / "map"});
  const std::string page = read_text(out / "r.html");
  const size_t frames = file_json(out / "r.json")["query"]["frames"].get<size_t>();
  // A card's caption names the frame of the query, and the file that it shows.
  size_t captions = 0;
  for (size_t at = page.find("<figcaption>query "); at != std::string::npos;
       at = page.find("<figcaption>query ", at + 1)) {
    const size_t frame = std::stoul(page.substr(at + 18));
    const size_t name = page.find(": ", at) + 2;
    CHECK(std::stoul(page.substr(name)) == frames - 1 - frame);
    ++captions;
  }
  CHECK(captions > 0);
  CHECK(list_folder(out / "map").size() > 1);
}

TEST_CASE("an invalid speed is a usage error") {
  const TemporaryFolder out;
  check_failure(single(out / "r.json", {"--speed", "stop"}), 2, "stops");
  for (const char* pace : {"0", "nan", "1e9", "-1"})
    check_failure(single(out / "r.json", {std::string("--speed=") + pace}), 2, "from 0.1 to 10");
  const auto of_frames = [&](const std::string& frames, const std::string& speed) {
    return run_program(
        "vpr-query", {world().database(), "--query", world().walk("back") + "@0:" + frames, "--c-l",
                      "1", "--t-r", "0.3", "--speed", speed, "-o", out / "r.json"});
  };
  check_failure(of_frames("3", "kidnap"), 2, "41 frames or more, found 3");
  ok(of_frames("1", "stops"));
  CHECK(file_json(out / "r.json")["query"]["frames"] == 1);
}

TEST_CASE("windows of several rates equal the definition, and store the rate of best matches") {
  const TemporaryFolder out;
  const auto run = [&](const std::string& name, const Words& more) {
    return run_program("vpr-query", joined({world().database(), "--dataset", world().dataset(),
                                            "--c-l", "8", "--t-r", "0", "-o", out / name},
                                           more));
  };
  const Words rates = {"--rates", "1/2,2/3,1,3/2,2"};
  for (const char* score : {"raw", "zscore"}) {
    INFO(score);
    ok(run("r.json", joined(rates, {"--score", score, "--speed", "2", "--force"})));
  }
  const auto found = read_array<double>(out / "r.best_rates.npy");
  const Json result = file_json(out / "r.json");
  CHECK(result["settings"]["rates"] == Json{"1/2", "2/3", "1", "3/2", "2"});
  REQUIRE(found.size() == result["query"]["windows"].get<size_t>());
  CHECK(std::count(found.begin(), found.end(), 2.0) > static_cast<long>(found.size() / 2));
  CHECK(evaluate(out / "r.json")["best_match"]["correct"].get<int>() > 0);

  ok(run("one.json", {"--rates", "1"}));
  ok(run("plain.json", {}));
  CHECK(read_text(out / "one.best.npy") == read_text(out / "plain.best.npy"));
  CHECK(file_json(out / "plain.json")["settings"]["rates"].empty());
  check_failure(run("x.json", joined(rates, {"--method", "openable"})), 2, "--rates");
  check_failure(run("x.json", {"--rates", "0/1"}), 2, "3/2");
  check_failure(run("x.json", {"--rates", "1,2/2"}), 2, "twice");
}
