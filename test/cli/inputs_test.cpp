// Wrong inputs of matrices, descriptors, lists and ground truth, as a user brings them.
#include <filesystem>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/json.h"
#include "base/random.h"
#include "support.h"
#include "world.h"

using namespace vpr;
using test::check_failure;
using test::printed_json;
using test::run_program;
using test::world;

namespace {

using Words = std::vector<std::string>;

test::RunOutcome evaluate(const Words& words) { return run_program("vpr-eval", words); }

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Distances of `queries` frames to `references` frames; query i is closest to reference
/// step * i + off.
std::string distances(const test::TemporaryFolder& folder, size_t queries, size_t references,
                      size_t step = 1, size_t off = 0) {
  RandomEngine engine(7);
  std::vector<float> values;
  for (size_t q = 0; q < queries; ++q)
    for (size_t r = 0; r < references; ++r)
      values.push_back(static_cast<float>(uniform_unit(engine) + (r == step * q + off ? 0 : 2)));
  test::write_array(folder / "d.npy", values, {queries, references});
  return folder / "d.npy";
}

/// A .npy file of that shape and no values.
std::string empty_array(const test::TemporaryFolder& folder, const std::vector<size_t>& shape) {
  test::write_text(folder / "empty.npy", npy_header("|u1", shape));
  return folder / "empty.npy";
}

/// A result of the walk "back".
std::string result_of_back(const test::TemporaryFolder& folder) {
  REQUIRE(run_program("vpr-query", {world().database(), "--query", world().walk("back"), "--c-l",
                                    "10", "-o", folder / "r.json", "--quiet"})
              .exit_code == 0);
  return folder / "r.json";
}

}  // namespace

TEST_CASE("rows of descriptors are frames and not windows") {
  const test::TemporaryFolder folder;
  const std::string scores = distances(folder, 20, 20);
  check_failure(evaluate({"--query-npy", scores, "--reference-npy", scores, "--ground-truth",
                          "aligned", "--rows-are-windows-of", "10"}),
                2, "vpr-query --query-npy --c-l N");
}

TEST_CASE("rows of scores are windows of as many frames as the query has") {
  const test::TemporaryFolder folder;
  const Words words = {"--scores", distances(folder, 20, 20), "--distance", "--ground-truth",
                       "aligned"};
  const auto windows_of = [&](const std::string& length, const Words& more) {
    Words all = words;
    all.insert(all.end(), {"--rows-are-windows-of", length, "--json"});
    all.insert(all.end(), more.begin(), more.end());
    return evaluate(all);
  };
  CHECK(printed_json(windows_of("5", {}))["localisation"]["frames"] == 24);
  CHECK(printed_json(windows_of("5", {"--query-frames", "24"}))["settings"]["window"] == 5);
  check_failure(windows_of("5", {"--query-frames", "20"}), 4,
                "need a query of 24 frames, found 20");
  check_failure(windows_of("30", {}), 4, "20 rows are fewer than the frames of one window, 30");
  CHECK(printed_json(windows_of("30", {"--query-frames", "49"}))["localisation"]["frames"] == 49);
  std::filesystem::create_directory(folder / "q");
  for (int i = 0; i < 20; ++i) test::write_image(folder / fmt::format("q/{:02}.png", i), 1);
  check_failure(windows_of("5", {"--query", folder / "q"}), 4, "found 20");
}

TEST_CASE("a ground truth that is some frames off is told from a method that fails") {
  const test::TemporaryFolder folder;
  const auto warning = [&](const std::string& scores, const Words& more) {
    Words words = {"--scores", scores, "--distance", "--ground-truth", "aligned"};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = evaluate(words);
    CHECK(run.exit_code == 0);
    return run.err;
  };
  const std::string off = distances(folder, 20, 22, 1, 2);
  CHECK(warning(off, {}) ==
        "warning: all 20 best matches are within 2 frames of the ground truth: --tolerance 2?\n");
  CHECK(warning(off, {"--tolerance", "2"}).empty());
  const std::string fast = distances(folder, 20, 40, 2);
  CHECK(warning(fast, {"--tolerance", "1"}) ==
        "warning: the query has 20 frames and the training sequence 40: --reference-step 2?\n");
  CHECK(warning(fast, {"--reference-step", "2"}).empty());
  CHECK(warning(distances(folder, 20, 40), {}).empty());  // right, whatever the lengths
}

TEST_CASE("scores of the other order are told by their recall") {
  const test::TemporaryFolder folder;
  const std::string scores = distances(folder, 20, 20);
  const auto run = evaluate({"--scores", scores, "--similarity", "--ground-truth", "aligned"});
  CHECK(has(run.err, "d.npy: R@1 is "));
  CHECK(has(run.err, " % with --similarity and 100.0 % with --distance\n"));
  CHECK(evaluate({"--scores", scores, "--distance", "--ground-truth", "aligned"}).err.empty());
}

TEST_CASE("descriptors of another length may be transposed") {
  const test::TemporaryFolder folder;
  const std::vector<float> values(12 * 5, 1);
  test::write_array(folder / "q.npy", values, {5, 12});
  test::write_array(folder / "r.npy", values, {12, 5});
  check_failure(evaluate({"--query-npy", folder / "q.npy", "--reference-npy", folder / "r.npy",
                          "--ground-truth", "aligned"}),
                4, "of length 12 (5 x 12)");
  check_failure(evaluate({"--query-npy", folder / "q.npy", "--reference-npy", folder / "r.npy",
                          "--ground-truth", "aligned"}),
                4, "is an array transposed?");
}

TEST_CASE("pairs name frames by number or by file") {
  const test::TemporaryFolder folder;
  const std::string result = result_of_back(folder);
  const std::filesystem::path truth = world().truth("back");
  std::string named = "query,sequence,reference\n";
  std::string stems = named;
  std::string numbers = named;
  for (int i = 0; i < 12; ++i) {
    const auto name = [&](const std::string& walk, size_t frame) {
      return test::list_folder(world().walk(walk)).at(frame);
    };
    const std::string query = name("back", size_t(i));
    const std::string reference = name("one", size_t(20 - i));
    named += fmt::format("{},one,{}\n", query, reference);
    stems += fmt::format("x/{},one,{}\n", query, reference);
    numbers += fmt::format("{},one,{}\n", i, 20 - i);
  }
  test::write_text(folder / "named.csv", named);
  test::write_text(folder / "stems.csv", stems);
  test::write_text(folder / "numbers.csv", numbers);
  const auto counts = [&](const std::string& name, const Words& more = {}) {
    Words words = {result, "--ground-truth", folder / name, "--json", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return printed_json(evaluate(words))["best_match"];
  };
  const Json expected = counts("numbers.csv");
  CHECK(expected["without_match"] != expected["queries"]);
  CHECK(counts("named.csv") == expected);  // of the query and the database of the run
  CHECK(counts("stems.csv") == expected);
  CHECK(counts("named.csv", {"--query", world().walk("back"), "--train", world().walk("one"),
                             "--train", world().walk("two")}) == expected);
  test::write_text(folder / "bad.csv", "query,sequence,reference\nnone.png,one,1\n");
  check_failure(evaluate({result, "--ground-truth", folder / "bad.csv"}), 4,
                "bad.csv, line 2: query \"none.png\" is neither a frame number nor the name");
  check_failure(evaluate({"check", folder / "named.csv"}), 4, "--query and --train");
}

TEST_CASE("a slip on the command line is answered with what was meant") {
  check_failure(run_program("vpr-train", {"--train", "monday", "-o", "x"}), 2,
                "give a command: fastable, ");
  check_failure(run_program("vpr-query", {world().database(), "tuesday"}), 2,
                "unexpected argument tuesday; did you mean --query tuesday?");
  check_failure(run_program("vpr-train", {"fastable", "monday"}), 2,
                "did you mean --train monday?");
  check_failure(
      run_program("vpr-query", {world().database(), "--query", world().walk("back") + "@20"}), 3,
      "A range is FIRST:LAST[:STEP], as in " + world().walk("back") + "@0:100");
  check_failure(evaluate({world().database(), "--ground-truth", "aligned"}), 4,
                "is a database; give a result of vpr-query");
}

TEST_CASE("training images of several sizes are warned of") {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "walk");
  for (int i = 0; i < 6; ++i)
    test::write_image(folder / fmt::format("walk/{}.png", i), uint64_t(i), i == 4 ? 50 : 40);
  const auto run = run_program("vpr-train", {"fastable", "--train", folder / "walk", "--c-l", "2",
                                             "-o", folder / "w.vprdb"});
  CHECK(run.exit_code == 0);
  CHECK(
      has(run.err, "walk: 1 of 6 images are not 40 x 30 like 0.png; the first is 4.png, 50 x 30"));
}

TEST_CASE("sizes that an input asks for are bounded before the work") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "far.csv", "query,reference\n4194303,4194303\n");
  for (const char* name : {"gt.npy", "gt.npz"})
    check_failure(evaluate({"convert", folder / "far.csv", "--to", "matrix", "-o", folder / name}),
                  4, "17592186044416 values of a matrix");
  check_failure(
      evaluate({"convert", "aligned", "--tolerance", "1000000", "--query-frames", "1000000",
                "--train-frames", "1000000", "--to", "pairs", "-o", folder / "p.csv"}),
      4, "pairs; the limit is");
  test::write_text(folder / "far.txt", "99999 99999\n");
  check_failure(evaluate({"--predictions", folder / "far.txt", "--ground-truth", "aligned"}), 4,
                "line 1: the frame numbers up to here need 100000 x 100000 scores");
  for (const auto& shape :
       {std::vector<size_t>{2147483648, 0}, std::vector<size_t>{0, 2147483648}}) {
    const Words scores = {"--scores", empty_array(folder, shape), "--distance"};
    for (const Words& more : {Words{"--ground-truth", "aligned"}, Words{"--pairs", folder / "x"}}) {
      Words words = scores;
      words.insert(words.end(), more.begin(), more.end());
      check_failure(evaluate(words), 4, "expected a matrix of scores");
    }
  }
}

TEST_CASE("a result is judged by its own query of a data set with several queries") {
  const test::TemporaryFolder out;
  REQUIRE(run_program("vpr-query", {world().database(), "--dataset", world().dataset(), "--c-l",
                                    "10", "--t-r", "0.3", "-o", out / "r.json"})
              .exit_code == 0);
  const auto counts = [&](const std::string& dataset) {
    return printed_json(evaluate({out / "r.json", "--dataset", dataset, "--json"}))["counts"];
  };
  CHECK(counts(world().walk("dataset.json")) == counts(world().dataset()));
}
