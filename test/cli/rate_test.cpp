// --fps as a user gives it: what is kept of recordings, and what is judged of it.
#include <algorithm>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "base/npy.h"
#include "cli/world.h"
#include "support.h"

using namespace vpr;
using test::run_program;
using test::world;
namespace fs = std::filesystem;

namespace {

using Words = std::vector<std::string>;

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

test::RunOutcome query(const std::string& database, const std::string& output, const Words& more) {
  return run_program("vpr-query", joined({database, "--t-r", "0.3", "-o", output}, more));
}

// The query "back" in single frames, so that what is right does not depend on those beside.
test::RunOutcome single(const std::string& output, const Words& more) {
  return query(world().database(), output,
               joined({"--query", world().walk("back"), "--c-l", "1"}, more));
}

Json evaluate(const std::string& result, const Words& more = {}) {
  return test::printed_json(run_program(
      "vpr-eval", joined({result, "--ground-truth", world().truth("back"), "--json"}, more)));
}

std::string outcomes(const Json& report) { return report["outcomes"]["best"].get<std::string>(); }

std::vector<std::string> images_of(const std::string& walk) {
  std::vector<std::string> names;
  for (const std::string& name : test::list_folder(walk))
    if (name.ends_with(".png")) names.push_back(name);
  return names;
}

// The frames of a walk under other names, `rate` a second from a moment on.
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

TEST_CASE("A thinned query is judged frame by frame as the query is, by the same ground truth") {
  const test::TemporaryFolder out;
  REQUIRE(single(out / "plain.json", {}).exit_code == 0);
  const Json plain = evaluate(out / "plain.json");
  const std::string expected = outcomes(plain);
  REQUIRE(single(out / "thin.json", {"--recorded-fps", "30", "--fps", "10"}).exit_code == 0);
  const Json thin = evaluate(out / "thin.json");
  std::string kept;
  for (size_t i = 0; i < expected.size(); i += 3) kept += expected[i];
  CHECK(outcomes(thin) == kept);
  CHECK(thin["thinned"] == Json{{"fps", 10.0}, {"frames", expected.size()}});
  CHECK(has(thin["protocol"]["ground_truth"], ", query thinned to 10 frames a second"));
  const Json result = Json::parse(test::read_text(out / "thin.json"));
  CHECK(result["query"]["fps"] == 10.0);
  CHECK(result["query"]["frames"] == kept.size());
  const NpyArray sources(out / "thin.source_frames.npy");
  CHECK(sources.values<int32_t>(1)[2] == 6);
  // Thinned, and then replayed.
  const auto both =
      single(out / "both.json", {"--recorded-fps", "30", "--fps", "10", "--warp", "reversed"});
  REQUIRE(both.exit_code == 0);
  CHECK(has(both.out, "back, thinned to 10 frames a second, replayed by reversed"));
  CHECK(outcomes(evaluate(out / "both.json")) == std::string(kept.rbegin(), kept.rend()));
  // The recording's own rate leaves nothing out.
  REQUIRE(single(out / "same.json", {"--recorded-fps", "30", "--fps", "30"}).exit_code == 0);
  CHECK(outcomes(evaluate(out / "same.json")) == expected);
  CHECK_FALSE(Json::parse(test::read_text(out / "same.json"))["query"].contains("thinned"));
}

TEST_CASE("Names, lists and even rates keep the same frames, followed or not") {
  const test::TemporaryFolder out;
  const std::string walk = world().walk("back");
  const size_t frames = images_of(walk).size();
  name_by_time(walk, out / "named", 1305031102000, 100);
  std::string times = "time\n";
  for (size_t i = 0; i < frames; ++i) times += fmt::format("{}.{}\n", 70 + i / 10, i % 10);
  test::write_text(out / "times.csv", times);
  const auto run = [&](const std::string& name, const Words& more) {
    const auto outcome = query(world().database(), out / (name + ".json"),
                               joined({"--c-l", "2", "--fps", "4"}, more));
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return test::read_text(out / (name + ".source_frames.npy")) +
           test::read_text(out / (name + ".best.npy"));
  };
  const std::string even = run("even", {"--query", walk, "--recorded-fps", "10"});
  CHECK(run("named", {"--query", out / "named"}) == even);
  CHECK(run("list", {"--query", walk, "--query-times", out / "times.csv"}) == even);
  std::string list;
  for (const std::string& name : images_of(out / "named"))
    list += (out / "named/").string() + name + "\n";
  test::write_text(out / "list.txt", list);
  CHECK(run("list2", {"--query", out / "list.txt"}) == even);
  const Words live = {world().database(), "--c-l", "2", "--t-r",   "200",    "--t-r-scale", "bits",
                      "--follow",         "--fps", "4", "--quiet", "--query"};
  const auto followed = run_program("vpr-query", joined(live, {out / "list.txt"}));
  INFO(followed.err);
  REQUIRE(followed.exit_code == 0);
  CHECK(static_cast<size_t>(std::count(followed.out.begin(), followed.out.end(), '\n')) ==
        NpyArray(out / "even.source_frames.npy").shape()[0]);
  CHECK(has(followed.out, "\"1305031102.200.png\""));
  CHECK_FALSE(has(followed.out, "\"1305031102.100.png\""));
  test::check_failure(run_program("vpr-query", joined(live, {walk, "--query-times", "t.csv"})), 2,
                      "--query-times can't be given with --follow");
}

TEST_CASE("Thinned training frames keep the ground truth of the recordings") {
  const test::TemporaryFolder out;
  const std::string database = out / "thin.vprdb";
  const Words train = {"fastable", "--train", world().walk("one"),
                       "--c-l",    "2",       "--recorded-fps",
                       "12",       "-o",      database};
  const auto trained = run_program("vpr-train", joined(train, {"--fps", "4"}));
  INFO(trained.err);
  REQUIRE(trained.exit_code == 0);
  const size_t recorded = images_of(world().walk("one")).size();
  const size_t kept = (recorded + 2) / 3;
  CHECK(has(trained.out, fmt::format("{} of {}", kept, recorded)));
  const auto info = run_program("vpr-train", {"info", database, "--json"});
  const Json sequence = test::printed_json(info)["sequences"][0];
  CHECK(sequence["fps"] == 4.0);
  CHECK(sequence["thinned"] == Json{{"fps", 4.0}, {"frames", recorded}});
  // A walk against itself: frame i is frame i of the recording, and of the kept ones the nearest.
  REQUIRE(
      query(database, out / "r.json", {"--query", world().walk("one"), "--c-l", "1"}).exit_code ==
      0);
  const Json report = test::printed_json(
      run_program("vpr-eval", {out / "r.json", "--ground-truth", "aligned", "--json"}));
  CHECK(has(report["protocol"]["ground_truth"], "training frames thinned to 4 frames a second"));
  CHECK(report["best_match"]["without_match"] == 0);
  const std::string best = outcomes(report);
  for (size_t i = 0; i < best.size(); i += 3) CHECK(best[i] == 'c');
  // Kept ones are changed with their file.
  test::write_text(out / "r.train_source_frames.npy", "no");
  CHECK(run_program("vpr-eval", {out / "r.json", "--ground-truth", "aligned"}).exit_code == 4);
}

TEST_CASE("Two rates are warned of, unless the method finds them") {
  const test::TemporaryFolder out;
  const std::string database = out / "w.vprdb";
  REQUIRE(run_program("vpr-train", {"fastable", "--train", world().walk("one"), "--c-l", "5",
                                    "--recorded-fps", "8", "-o", database})
              .exit_code == 0);
  const auto warned = [&](const Words& more) {
    const auto outcome =
        run_program("vpr-query", joined({database, "--query", world().walk("back"), "-o",
                                         out / "r.json", "--force", "--c-l", "5", "--t-r", "0.5"},
                                        more));
    INFO(outcome.err);
    CHECK(outcome.exit_code == 0);
    return outcome.err;
  };
  CHECK(has(warned({"--recorded-fps", "24"}),
            "the query has 24 frames a second and the training sequence one has 8"));
  CHECK(has(warned({"--recorded-fps", "24"}), "give the query --fps 8, or use --method filter"));
  CHECK(has(warned({"--recorded-fps", "4"}), "give vpr-train --fps 4"));
  CHECK_FALSE(has(warned({"--recorded-fps", "24", "--fps", "8"}), "frames a second"));
  CHECK_FALSE(has(warned({"--recorded-fps", "8.5"}), "frames a second"));
  CHECK_FALSE(has(warned({}), "frames a second"));
  CHECK_FALSE(has(warned({"--recorded-fps", "24", "--rates", "1,1/3"}), "frames a second"));
  const auto filter =
      run_program("vpr-query", {database, "--query", world().walk("back"), "-o", out / "f.json",
                                "--method", "filter", "--recorded-fps", "24"});
  CHECK_FALSE(has(filter.err, "frames a second"));
}

TEST_CASE("What has no rate, or times that are none, is refused with what to do") {
  const test::TemporaryFolder out;
  const std::string walk = world().walk("back");
  const auto run = [&](const Words& more) {
    return query(world().database(), out / "r.json", joined({"--query", walk}, more));
  };
  test::check_failure(run({"--fps", "4"}), 2, "nothing says when its frames were taken");
  test::check_failure(run({"--fps", "0", "--recorded-fps", "8"}), 2, "--fps must be above 0");
  test::check_failure(run({"--recorded-fps", "-1"}), 2, "--recorded-fps must be above 0");
  test::write_text(out / "falling.csv", "1\n2\n1.5\n");
  test::check_failure(run({"--fps", "4", "--query-times", out / "falling.csv"}), 4,
                      "falling.csv, line 3");
  test::write_text(out / "repeated.csv", "1\n2\n2\n");
  test::check_failure(run({"--fps", "4", "--query-times", out / "repeated.csv"}), 4,
                      "repeated.csv, line 3");
  test::write_text(out / "few.csv", "1\n2\n3\n");
  test::check_failure(run({"--fps", "4", "--query-times", out / "few.csv"}), 4, "has 3 times");
  test::check_failure(run({"--fps", "4", "--query-times", out / "none.csv"}), 3, "none.csv");
  // One frame is kept, whatever the rate.
  const auto one = run_program(
      "vpr-query", {world().database(), "--query", walk + "@0:1", "--c-l", "1", "--t-r", "0.3",
                    "--fps", "4", "--recorded-fps", "30", "-o", out / "one.json"});
  CHECK(one.exit_code == 0);
  test::check_failure(run_program("vpr-train", {"add", world().fabmap(), "--train", walk, "--fps",
                                                "2", "-o", out / "f.vprdb"}),
                      2, "not thinned by --fps");
}
