// Matrices, descriptors, lists and ground truth as input and output.
#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/random.h"
#include "world.h"

using namespace vpr;
using namespace vpr::test;

namespace {

RunOutcome evaluate(const Words& words, const Words& more = {}) {
  return run_program("vpr-eval", joined(words, more));
}

/// Distances of `queries` frames to `references` frames; query i is closest to reference
/// step * i + off.
std::string distances(const TemporaryFolder& folder, size_t queries, size_t references,
                      size_t step = 1, size_t off = 0) {
  RandomEngine engine(7);
  std::vector<float> values;
  for (size_t q = 0; q < queries; ++q)
    for (size_t r = 0; r < references; ++r)
      values.push_back(static_cast<float>(uniform_unit(engine) + (r == step * q + off ? 0 : 2)));
  write_array(folder / "d.npy", values, {queries, references});
  return folder / "d.npy";
}

constexpr size_t kFrames = 20;

/// Similarities of 20 queries to 20 references: the correct one is often among the best.
struct Scored {
  TemporaryFolder folder;
  Scored() {
    RandomEngine engine(5);
    std::vector<double> scores;
    std::string queries;
    std::string references;
    for (size_t j = 0; j < kFrames; ++j) {
      for (size_t i = 0; i < kFrames; ++i)
        scores.push_back(uniform_unit(engine) + (i == j ? 0.6 : 0));
      queries += fmt::format("query/{:02}.jpg\n", j);
      references += fmt::format("db/{:02}.jpg\n", j);
    }
    write_array(folder / "s.npy", scores, {kFrames, kFrames});
    write_text(folder / "q.txt", queries);
    write_text(folder / "db.txt", references);
  }
  std::string path(const std::string& name) const { return folder / name; }
  Words named() const { return {"--query", path("q.txt"), "--train", path("db.txt")}; }
};

const Words kTruth = {"--ground-truth", "aligned", "--tolerance", "0", "--json"};

/// The frame distances of the rendered sequences, as a matrix.
struct Matrix {
  TemporaryFolder folder;
  size_t queries = 0;
  size_t references = 0;
  std::vector<int32_t> distances;

  Matrix() {
    const Json json =
        printed_json("vpr-query", {world().database(), "--query", world().walk("back"), "--c-l",
                                   "1", "--t-r", "0.1", "--save-matrix", path("s.npy"), "--json"});
    const NpyArray array(path("s.npy"));
    const auto values = array.values<int32_t>(2);
    distances.assign(values.begin(), values.end());
    queries = array.shape()[0];
    references = array.shape()[1];
    for (const Json& target : json["sequences"]) frames.push_back(target["frames"]);
    // Similarities with references first: multiples of 1/1024 below 2.
    std::vector<double> similarities(distances.size());
    for (size_t j = 0; j < queries; ++j)
      for (size_t i = 0; i < references; ++i)
        similarities[i * queries + j] = 2 - distances[j * references + i] / 1024.0;
    write_array(path("turned.npy"), similarities, {references, queries});
  }
  std::vector<size_t> frames;  ///< of training sequences
  std::string path(const std::string& name) const { return folder / name; }
  /// As in the database.
  Words sequences() const {
    return {"--train-sequence", fmt::format("one=0:{}", frames[0]), "--train-sequence",
            fmt::format("two={}:{}", frames[0], frames[0] + frames[1])};
  }
};

const Matrix& matrix() {
  static const Matrix kShared;
  return kShared;
}

RunOutcome query_matrix(const std::string& file, const Words& words,
                        const Words& how = {"--distance"}) {
  return run_program("vpr-query", joined({"matrix", matrix().path(file)},
                                         joined(how, joined(matrix().sequences(), words))));
}

}  // namespace

TEST_CASE("rows of descriptors are frames, not windows") {
  const TemporaryFolder folder;
  const std::string scores = distances(folder, 20, 20);
  check_failure(evaluate({"matrix", "--query-npy", scores, "--train-npy", scores, "--ground-truth",
                          "aligned", "--rows-are-windows-of", "10"}),
                2, "vpr-query --query-npy --c-l N");
}

TEST_CASE("rows of scores are windows of the length given by the query") {
  const TemporaryFolder folder;
  const Words words = {"matrix", distances(folder, 20, 20), "--distance", "--ground-truth",
                       "aligned"};
  const auto windows_of = [&](const std::string& length, const Words& more) {
    return evaluate(joined(words, {"--rows-are-windows-of", length, "--json"}), more);
  };
  CHECK(printed_json(windows_of("5", {}))["localization"]["frames"] == 24);
  CHECK(printed_json(windows_of("5", {"--query-frames", "24"}))["settings"]["window"] == 5);
  check_failure(windows_of("5", {"--query-frames", "20"}), 4,
                "need a query of 24 frames, found 20");
  check_failure(windows_of("30", {}), 4, "20 rows are fewer than the frames of one window, 30");
  CHECK(printed_json(windows_of("30", {"--query-frames", "49"}))["localization"]["frames"] == 49);
  std::filesystem::create_directory(folder / "q");
  for (int i = 0; i < 20; ++i) write_image(folder / fmt::format("q/{:02}.png", i), 1);
  check_failure(windows_of("5", {"--query", folder / "q"}), 4, "found 20");
}

TEST_CASE("a shifted ground truth is distinguished from a failing method") {
  const TemporaryFolder folder;
  const auto warning = [&](const std::string& scores, const Words& more) {
    return ok(evaluate({"matrix", scores, "--distance", "--ground-truth", "aligned"}, more)).err;
  };
  const std::string off = distances(folder, 20, 22, 1, 2);
  CHECK(warning(off, {}) == "warning: all 20 best matches are within 2 frames of the truth\n");
  CHECK(warning(off, {"--tolerance", "2"}).empty());
  const std::string fast = distances(folder, 20, 40, 2);
  CHECK(warning(fast, {"--tolerance", "1"}) ==
        "warning: the query has 20 frames and the training sequence 40: --train-step 2?\n");
  CHECK(warning(fast, {"--train-step", "2"}).empty());
  CHECK(warning(distances(folder, 20, 40), {}).empty());  // correct for any lengths
}

TEST_CASE("scores of the wrong order are detected by their recall") {
  const TemporaryFolder folder;
  const std::string scores = distances(folder, 20, 20);
  const auto run = evaluate({"matrix", scores, "--similarity", "--ground-truth", "aligned"});
  CHECK(has(run.err, "d.npy: R@1 is "));
  CHECK(has(run.err, " % with --similarity and 100.0 % with --distance\n"));
  CHECK(evaluate({"matrix", scores, "--distance", "--ground-truth", "aligned"}).err.empty());
}

TEST_CASE("pairs name frames by number or by file") {
  const TemporaryFolder folder;
  const std::string result = folder / "r.json";
  run_ok("vpr-query", {world().database(), "--query", world().walk("back"), "--c-l", "10", "-o",
                       result, "--quiet"});
  std::string named = "query,sequence,reference\n";
  std::string stems = named;
  std::string numbers = named;
  for (int i = 0; i < 12; ++i) {
    const std::string query = images_of(world().walk("back")).at(size_t(i));
    const std::string reference = images_of(world().walk("one")).at(size_t(20 - i));
    named += fmt::format("{},one,{}\n", query, reference);
    stems += fmt::format("x/{},one,{}\n", query, reference);
    numbers += fmt::format("{},one,{}\n", i, 20 - i);
  }
  write_text(folder / "named.csv", named);
  write_text(folder / "stems.csv", stems);
  write_text(folder / "numbers.csv", numbers);
  const auto counts = [&](const std::string& name, const Words& more = {}) {
    return printed_json(evaluate(joined(
        {result, "--ground-truth", folder / name, "--json", "--quiet"}, more)))["best_match"];
  };
  const Json expected = counts("numbers.csv");
  CHECK(expected["without_match"] != expected["frames"]);
  CHECK(counts("named.csv") == expected);  // the query and the database of the run
  CHECK(counts("stems.csv") == expected);
  CHECK(counts("named.csv", {"--query", world().walk("back"), "--train", world().walk("one"),
                             "--train", world().walk("two")}) == expected);
  write_text(folder / "bad.csv", "query,sequence,reference\nnone.png,one,1\n");
  check_failure(evaluate({result, "--ground-truth", folder / "bad.csv"}), 4,
                "bad.csv, line 2: query \"none.png\" is neither a frame number nor the name");
  check_failure(evaluate({"check", folder / "named.csv"}), 4, "--query and --train");
}

TEST_CASE("a mistake on the command line is answered with a suggestion") {
  check_failure("vpr-train", {"--train", "monday", "-o", "x"}, 2,
                "a command is missing: fastable, ");
  check_failure("vpr-query", {world().database(), "tuesday"}, 2,
                "unexpected argument tuesday; did you mean --query tuesday?");
  check_failure("vpr-train", {"fastable", "monday"}, 2, "did you mean --train monday?");
  check_failure("vpr-query", {world().database(), "--query", world().walk("back") + "@20"}, 3,
                "A range is FIRST:LAST[:STEP], as in " + world().walk("back") + "@0:100");
  check_failure(evaluate({world().database(), "--ground-truth", "aligned"}), 4,
                "is a database. Pass a result of vpr-query");
}

TEST_CASE("training images of several sizes cause a warning") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "walk");
  for (int i = 0; i < 6; ++i)
    write_image(folder / fmt::format("walk/{}.png", i), uint64_t(i), i == 4 ? 50 : 40);
  const auto run = run_ok("vpr-train", {"fastable", "--train", folder / "walk", "--c-l", "2", "-o",
                                        folder / "w.vprdb"});
  CHECK(
      has(run.err, "walk: 1 of 6 images are not 40 x 30 like 0.png; the first is 4.png, 50 x 30"));
}

TEST_CASE("sizes requested by an input are limited before the work") {
  const TemporaryFolder folder;
  write_text(folder / "far.csv", "query,reference\n4194303,4194303\n");
  for (const char* name : {"gt.npy", "gt.npz"})
    check_failure(evaluate({"convert", folder / "far.csv", "--to", "matrix", "-o", folder / name}),
                  4, "17592186044416 values of a matrix");
  check_failure(
      evaluate({"convert", "aligned", "--tolerance", "1000000", "--query-frames", "1000000",
                "--train-frames", "1000000", "--to", "pairs", "-o", folder / "p.csv"}),
      4, "pairs; the limit is");
  write_text(folder / "far.txt", "99999 99999\n");
  check_failure(evaluate({"matrix", folder / "far.txt", "--ground-truth", "aligned"}), 4,
                "line 1: the frame numbers up to here need 100000 x 100000 scores");
  for (const auto& shape :
       {std::vector<size_t>{2147483648, 0}, std::vector<size_t>{0, 2147483648}}) {
    write_text(folder / "empty.npy", npy_header("|u1", shape));
    for (const Words& more : {Words{"--ground-truth", "aligned"}, Words{"--pairs", folder / "x"}})
      check_failure(evaluate({"matrix", folder / "empty.npy", "--distance"}, more), 4,
                    "expected a matrix of scores");
  }
}

TEST_CASE("a result is evaluated with its own query of a data set with several queries") {
  const TemporaryFolder out;
  run_ok("vpr-query", {world().database(), "--dataset", world().dataset(), "--c-l", "10", "--t-r",
                       "0.3", "-o", out / "r.json"});
  const auto counts = [&](const std::string& dataset) {
    return printed_json(evaluate({out / "r.json", "--dataset", dataset, "--json"}))["counts"];
  };
  CHECK(counts(world().walk("dataset.json")) == counts(world().dataset()));
}

TEST_CASE("written pairs can be read back, with the recall of the scores") {
  const Scored scored;
  const Words source = {"matrix", scored.path("s.npy"), "--similarity"};
  const Json scores = printed_json(evaluate(source, kTruth));
  const auto written = ok(evaluate(
      source, joined({"--top-k", "10", "--pairs", scored.path("pairs.txt")}, scored.named())));
  CHECK(has(written.out, "200 pairs"));
  CHECK(read_text(scored.path("pairs.txt")).starts_with("query/00.jpg db/"));
  const Words read = {"matrix", scored.path("pairs.txt")};
  const Json pairs = printed_json(evaluate(joined(read, scored.named()), kTruth));
  for (const char* k : {"1", "5", "10"})
    CHECK(pairs["metrics"]["recall_at"][k] == scores["metrics"]["recall_at"][k]);
  CHECK(scores["metrics"]["recall_at"]["1"].get<double>() > 0.3);
  CHECK(scores["metrics"]["recall_at"]["1"].get<double>() < 1);
  // Together with a report, and with numbers as names.
  ok(evaluate(source, {"--ground-truth", "aligned", "--pairs", scored.path("numbers.txt"),
                       "--top-k", "1"}));
  CHECK(printed_json(evaluate({"matrix", scored.path("numbers.txt")},
                              kTruth))["metrics"]["recall_at"]["1"] ==
        scores["metrics"]["recall_at"]["1"]);
}

TEST_CASE("predictions of VPR-methods-evaluation are evaluated") {
  const Scored scored;
  std::filesystem::create_directory(scored.folder / "preds");
  for (size_t j = 0; j < kFrames; ++j)
    write_text(scored.folder / fmt::format("preds/{:03}.txt", j),
               fmt::format("Query path:\n/x/query/{:02}.jpg\n\nPredictions paths:\n"
                           "/x/db/{:02}.jpg\n/x/db/{:02}.jpg\n\nPositives paths:\n\n",
                           j, (j + j % 2) % kFrames, (j + 1) % kFrames));
  const Words words = {"matrix", scored.path("preds")};
  const Json report = printed_json(evaluate(joined(words, scored.named()), kTruth));
  CHECK(report["metrics"]["recall_at"]["1"] == 0.5);
  CHECK(report["machine"]["paths"]["predictions"] == scored.path("preds"));
}

TEST_CASE("pairs of a result are its best matches, or those of its matrix") {
  const TemporaryFolder out;
  run_ok("vpr-query", {world().database(), "--query", world().walk("back"), "--c-l", "5", "--t-r",
                       "0.5", "-o", out / "r.json", "--save-matrix", out / "m.npy"});
  const Words names = {"--query", world().walk("back"), "--train", world().walk("one"),
                       "--train", world().walk("two")};
  ok(evaluate({out / "r.json", "--pairs", out / "best.txt"}, names));
  ok(evaluate(
      {out / "r.json", "--matrix", out / "m.npy", "--top-k", "3", "--pairs", out / "three.txt"},
      names));
  const std::string one = read_text(out / "best.txt");
  const std::string all = read_text(out / "three.txt");
  CHECK(3 * std::count(one.begin(), one.end(), '\n') == std::count(all.begin(), all.end(), '\n'));
  CHECK(all.starts_with(one.substr(0, one.find('\n'))));
  CHECK(one.starts_with(world().walk("back")));
  check_failure(evaluate({out / "r.json", "--pairs", out / "x.txt"}), 2,
                "name the frames of all 2 training sequences");
  check_failure(evaluate({out / "r.json", "--pairs", out / "x.txt", "--top-k", "2"}), 2,
                "the matrix");
}

TEST_CASE("incompatible flags of lists are refused") {
  const Scored scored;
  write_text(scored.folder / "p.txt", "0 1 0.5\n");
  const auto check = [&](const Words& words, const std::string& word) {
    check_failure(evaluate({"matrix", scored.path("p.txt")}, words), 2, word);
  };
  check(kTruth, "has scores");
  check({"--query-npy", "q.npy", "--train-npy", "r.npy"}, "evaluate one of these");
  check({"--missing", "3", "--distance"}, "--missing");
  check({"--top-k", "3"}, "--top-k");
  check({"--top-k", "0", "--pairs", scored.path("x.txt")}, "--top-k must be");
  check_failure(evaluate({"matrix", scored.path("off_map.txt")}, kTruth), 3, "off_map.txt");
  check({"--similarity", "--pairs", scored.path("x.txt"), "-o", scored.path("x.json")},
        "-o needs a ground truth");
  for (const Words& words : {Words{"--pairs", "x"}, Words{"--junit", "x"}, Words{"--update"}}) {
    check_failure(evaluate({"r.json", "s.json", "--ground-truth", "aligned"}, words), 2,
                  "take one result");
    check_failure(evaluate({"r.json", "--protocol", "nordland-exact"}, words), 2, "protocol");
  }
}

TEST_CASE("windows of a matrix of frame distances equal those of the database") {
  const TemporaryFolder out;
  write_text(out / "openable.json", R"({"method": "openable"})");
  write_text(out / "online.json", R"({"method": "fastable-online"})");
  for (const Words& words :
       {Words{"--t-r", "0.65"}, Words{"--t-r", "0.7", "--config", out / "openable.json"},
        Words{"--t-r", "150", "--t-r-scale", "bits", "--config", out / "online.json"},
        Words{"--t-r", "0.8"}, Words{"--t-r", "0.65", "--only-sequence", "two"},
        Words{"--t-r", "0.65", "--rates", "1/2,1,2"},
        Words{"--decide", "margin", "--margin", "20"}}) {
    INFO(fmt::format("{}", fmt::join(words, " ")));
    const Words common = joined(
        words, {"--c-l", "10", "--exclusion-frames", "4", "--same-place", "none", "--force", "-o"});
    run_ok("vpr-query", joined({world().database(), "--query", world().walk("back")},
                               joined(common, {out / "coded.json"})));
    ok(query_matrix("s.npy", joined(common, {out / "read.json"})));
    for (const char* kind :
         {"recognitions", "recognition_scores", "best", "best_scores", "margins"})
      CHECK(read_text(out / fmt::format("coded.{}.npy", kind)) ==
            read_text(out / fmt::format("read.{}.npy", kind)));
    const Json json = file_json(out / "read.json");
    CHECK(json["scores"] ==
          Json{{"kind", "distance"}, {"best", 0.0}, {"unit", 1.0}, {"is_exact", true}});
    CHECK(json["clusters"] == file_json(out / "coded.json")["clusters"]);
  }
}

TEST_CASE("a result records the kind of scores of its matrix, and whether they were rounded") {
  const Json exact = printed_json(query_matrix("s.npy", {"--c-l", "7", "--t-r", "0.6", "--json"}));
  CHECK(exact["scores"]["is_exact"].get<bool>());
  const Json rounded = printed_json(query_matrix(
      "turned.npy", {"--c-l", "7", "--t-r", "0.6", "--json"}, {"--similarity", "--train-first"}));
  CHECK(rounded["scores"]["kind"] == "similarity");
  CHECK_FALSE(rounded["scores"]["is_exact"].get<bool>());
}

TEST_CASE("similarities have the best matches of distances, and are evaluated like any result") {
  const TemporaryFolder out;
  for (const char* score : {"raw", "zscore", "zscore-offline"}) {
    INFO(score);
    for (const auto& [file, how] :
         {std::pair("s.npy", Words{"--distance"}),
          std::pair("turned.npy", Words{"--similarity", "--train-first"})}) {
      ok(query_matrix(
          file,
          {"--c-l", "10", "--score", score, "--force", "-o", out / fmt::format("{}.json", file)},
          how));
    }
    const Json report = printed_json(
        "vpr-eval", {out / "s.npy.json", "--ground-truth", world().truth("back"), "--json"});
    const Json turned = printed_json(
        "vpr-eval", {out / "turned.npy.json", "--ground-truth", world().truth("back"), "--json"});
    CHECK(report["best_match"]["rate"].get<double>() > 0.5);
    CHECK(std::abs(report["best_match"]["rate"].get<double>() -
                   turned["best_match"]["rate"].get<double>()) < 0.03);
  }
}

TEST_CASE("a matrix alone reports the missing inputs") {
  const TemporaryFolder folder;
  const auto check = [](const Words& words, int code, const std::string& word) {
    check_failure("vpr-query", joined({"matrix", matrix().path("s.npy")}, words), code, word);
  };
  check({}, 2, "the order of the scores is missing");
  check({"--distance", "--decide", "margin"}, 2, "--exclusion-frames");
  for (const char* method : {"filter", "lsh"}) {
    write_text(folder / "c.json", fmt::format(R"({{"method": "{}"}})", method));
    check({"--distance", "--config", folder / "c.json"}, 2, "does not go with vpr-query matrix");
  }
  check({"--distance", "--query", "x"}, 2, "--query");
  check({"--distance", "--train-sequence", "a=0:100000"}, 2, "the matrix has");
  check({"--distance", "--train-sequence", "0:5"}, 2, "NAME=FIRST:LAST");
  check({"--distance", "--train-sequence", "a=0:5", "--train-sequence", "a=5:9"}, 2,
        "duplicate name of training sequences: a");
  check({"--distance", "--c-l", "100000"}, 2, "c_l");
  check_failure("vpr-query", {"--query", world().walk("back")}, 2, "the database is missing");
}
