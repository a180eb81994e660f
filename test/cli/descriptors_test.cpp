// Imported descriptors in all programs.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/random.h"
#include "world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

constexpr size_t kLength = 48;

std::vector<float> random_rows(size_t count, uint64_t seed) {
  RandomEngine engine(seed);
  std::vector<float> values;
  for (size_t i = 0; i < count * kLength; ++i)
    values.push_back(static_cast<float>(uniform_below(engine, 2001)) - 1000);
  return values;
}

/// 60 training frames, and a query of 24 frames that repeats frames 30 to 53 with small changes and
/// other lengths. With `with_gap`, frame 12 is missing.
struct Arrays {
  TemporaryFolder folder;
  Arrays() {
    const std::vector<float> train = random_rows(60, 1);
    const std::vector<float> noise = random_rows(24, 2);
    std::vector<float> query;
    for (size_t i = 0; i < noise.size(); ++i)
      query.push_back(0.01F * (train[30 * kLength + i] + 0.3F * noise[i]));
    write_array(path("db.npy"), train, {60, kLength});
    write_array(path("q.npy"), query, {24, kLength}, true);
    std::string names;
    for (int i = 0; i < 60; ++i) names += fmt::format("db/{:03}.jpg\n", i);
    write_text(path("names.txt"), names);
    for (const char* precision : {"8", "16"})
      run_ok("vpr-train", {"descriptors", "--npy", path("db.npy"), "--sequence", "one=0:28",
                           "--sequence", "two=28:60", "--names", path("names.txt"), "--c-l", "5",
                           "--value-bits", precision, "-o", database(precision)});
  }
  std::string path(const std::string& name) const { return folder / name; }
  std::string database(const std::string& precision = "8") const {
    return path("db" + precision + ".vprdb");
  }
};

const Arrays& arrays() {
  static const Arrays kShared;
  return kShared;
}

RunOutcome query(Words words, const std::string& precision = "8") {
  return run_program("vpr-query", joined({arrays().database(precision), "--query-npy",
                                          arrays().path("q.npy"), "--json"},
                                         words));
}

}  // namespace

TEST_CASE("a database of imported descriptors reports its content") {
  const Json narrow = printed_json("vpr-train", {"info", arrays().database(), "--json"});
  CHECK(narrow["descriptor"] == "vectors8");
  CHECK(narrow["length"] == kLength);
  REQUIRE(narrow["sequences"].size() == 2);
  CHECK(narrow["sequences"][1]["name"] == "two");
  CHECK(narrow["sequences"][1]["frames"] == 32);
  const auto text = run_program("vpr-train", {"info", arrays().database("16")});
  CHECK(has(text.out, "2 sequences, 60 frames, vectors of 48 numbers"));
  CHECK(read_text(arrays().path("db8.vprdb/frames.txt")) == read_text(arrays().path("names.txt")));
}

TEST_CASE("every decision and score supports imported descriptors, and cells are verified") {
  for (const std::string precision : {"8", "16"}) {
    for (const Words& words :
         {Words{"--c-l", "5", "--t-r", "auto"}, Words{"--c-l", "5", "--t-r", "0.5"},
          Words{"--c-l", "3", "--score", "zscore", "--t-r", "-3"},
          Words{"--c-l", "5", "--score", "zscore-offline", "--t-r", "-3"},
          Words{"--c-l", "5", "--method", "openable", "--t-r", "0.5"},
          Words{"--c-l", "5", "--method", "fastable-online", "--t-r", "0.5"},
          Words{"--c-l", "4", "--rates", "1/2,1,2", "--t-r", "0.5"}}) {
      const bool has_rates = words[2] == "--rates";
      INFO(fmt::format("{} bits, {}", precision, fmt::join(words, " ")));
      const Json json = printed_json(
          query(joined(words, has_rates ? Words{} : Words{"--verify", "60"}), precision));
      CHECK(json["totals"]["recognitions"] > 0);
      CHECK(json.contains("verification") == !has_rates);
      for (const Json& best : json["clusters"]) {
        CHECK(best["sequence"] == 1);
        CHECK(best["train"]["window"].get<int>() == best["query"]["window"].get<int>() + 2);
      }
    }
    const Json margins = printed_json(query(
        {"--c-l", "5", "--score", "zscore", "--decide", "margin", "--margin", "0.5"}, precision));
    CHECK(margins["totals"]["recognitions"] > 10);
    const Json filtered = printed_json(query({"--method", "filter", "--margin", "1"}, precision));
    CHECK(filtered["settings"]["method"] == "filter");
  }
}

TEST_CASE("imported descriptors are evaluated and swept like others") {
  const TemporaryFolder out;
  run_ok("vpr-train", {"descriptors", "--npy", arrays().path("db.npy") + "@30:54", "--c-l", "5",
                       "-o", out / "part.vprdb"});
  run_ok("vpr-query", {out / "part.vprdb", "--query", arrays().path("q.npy"), "--c-l", "5", "--t-r",
                       "0.5", "-o", out / "r.json"});
  const Json report =
      printed_json("vpr-eval", {out / "r.json", "--ground-truth", "aligned", "--tolerance", "0",
                                "--html", out / "r.html", "--json"});
  CHECK(report["best_match"]["correct"] == 20);  // all frames at which a window ends
  CHECK(report["best_match"]["frames"] == 24);
  check_failure("vpr-eval",
                {out / "r.json", "--ground-truth", "aligned", "--query", arrays().path("q.npy"),
                 "--html", out / "r2.html"},
                2, "plots need its images");
  const Json sweep =
      printed_json("vpr-tune", {"fastable", out / "part.vprdb", "--query", arrays().path("q.npy"),
                                "--ground-truth", "aligned", "--c-l", "1,5", "--json"});
  CHECK(has(sweep.dump(), "recommend"));
}

TEST_CASE("more sequences can be added, with the same descriptors only") {
  const TemporaryFolder out;
  run_ok("vpr-train",
         {"add", arrays().database(), "--train", arrays().path("q.npy"), "-o", out / "more.vprdb"});
  write_array(out / "short.npy", std::vector<float>(40, 1), {4, 10});
  check_failure("vpr-train",
                {"add", arrays().database(), "--train", out / "short.npy", "-o", out / "x.vprdb"},
                4, "short.npy: its descriptors have 10 numbers, descriptors of the database 48");
  check_failure("vpr-query", {arrays().database(), "--query-npy", out / "short.npy", "--c-l", "2"},
                4, "descriptors of the database have 48 numbers, descriptors of the query 10");
  check_failure("vpr-train",
                {"descriptors", "--npy", arrays().path("db.npy"), "--npy", out / "short.npy", "-o",
                 out / "x.vprdb"},
                4, "10 numbers, descriptors of the database 48");
}

TEST_CASE("images and descriptors of another kind are refused with the reason") {
  const TemporaryFolder out;
  const std::string images = world().walk("back");
  check_failure("vpr-query", {arrays().database(), "--query", images}, 4,
                "the database has imported descriptors");
  check_failure("vpr-query", {world().database(), "--query-npy", arrays().path("q.npy")}, 4,
                "holds descriptors, but frames of the database are described by ldb");
  check_failure("vpr-query", {world().fabmap(), "--query-npy", arrays().path("q.npy")}, 4,
                "images are needed");
  check_failure("vpr-query", {arrays().database(), "--query-npy", images}, 2, "is not a .npy file");
  check_failure("vpr-query",
                {arrays().database(), "--query-npy", arrays().path("q.npy"), "--query", images}, 2,
                "--query-npy cannot be combined with --query");
  const auto train = [&](Words words) {
    return run_program("vpr-train", joined({"descriptors", "-o", out / "x.vprdb"}, words));
  };
  const std::string db = arrays().path("db.npy");
  check_failure(train({}), 2, "--npy");
  check_failure(train({"--npy", images}), 2, "is not a .npy file");
  check_failure(train({"--npy", out / "missing.npy"}), 3, "missing.npy");
  check_failure(train({"--npy", db, "--bits"}), 4, "bits are uint8");
  check_failure(train({"--npy", db, "--value-bits", "12"}), 2, "16 or 8");
  check_failure(train({"--npy", db, "--bits", "--value-bits", "8"}), 2, "have no effect on --bits");
  check_failure(train({"--npy", db, "--sequence", "a"}), 2, "NAME=FIRST:LAST");
  check_failure(train({"--npy", db, "--sequence", "a=b"}), 2, "NAME=FIRST:LAST");
  check_failure(train({"--npy", db, "--sequence", "a=0:61"}), 2, "exceeds");
  check_failure(train({"--npy", db, "--sequence", "a=0:9", "--sequence", "a=9:20"}), 2,
                "two sequences have the name a");
  check_failure(train({"--npy", db, "--npy", db + "@0:9", "--sequence", "a=0:9"}), 2,
                "a single --npy");
  write_text(out / "few.txt", "a\nb\n");
  check_failure(train({"--npy", db, "--names", out / "few.txt"}), 4, "few.txt: names 2 frames");
  std::vector<float> values(12, 1);
  values[7] = std::numeric_limits<float>::quiet_NaN();
  write_array(out / "nan.npy", values, {4, 3});
  check_failure(train({"--npy", out / "nan.npy"}), 4, "nan.npy: row 2: value 1 is nan");
  write_text(out / "cut.npy", read_text(db).substr(0, 1000));
  check_failure(train({"--npy", out / "cut.npy"}), 4, "truncated");
  CHECK_FALSE(fs::exists(out / "x.vprdb"));
}

TEST_CASE("missing rows keep their index and never match") {
  const TemporaryFolder out;
  std::vector<float> values = random_rows(30, 5);
  std::fill_n(values.begin() + 12 * kLength, kLength, std::numeric_limits<float>::quiet_NaN());
  write_array(out / "gap.npy", values, {30, kLength});
  check_failure("vpr-train", {"descriptors", "--npy", out / "gap.npy", "-o", out / "g.vprdb"}, 4,
                "row 12 is missing");
  run_ok("vpr-train", {"descriptors", "--npy", out / "gap.npy", "--skip-unreadable", "--c-l", "3",
                       "-o", out / "g.vprdb"});
  const Json json =
      printed_json("vpr-query", {out / "g.vprdb", "--query-npy", out / "gap.npy", "--c-l", "3",
                                 "--t-r", "0.01", "--skip-unreadable", "--json"});
  CHECK(json["totals"]["recognitions"] == 28 - 3);  // the windows with frame 12 have none
}

TEST_CASE("bits from files match like LDB, also with hashing") {
  const TemporaryFolder out;
  RandomEngine engine(7);
  std::vector<uint8_t> codes(50 * 9);
  for (uint8_t& byte : codes) byte = static_cast<uint8_t>(uniform_below(engine, 256));
  write_array(out / "db.npy", codes, {50, 9});
  const std::vector<uint8_t> part(codes.begin() + 20 * 9, codes.begin() + 40 * 9);
  write_array(out / "q.npy", part, {20, 9}, true);
  run_ok("vpr-train",
         {"descriptors", "--npy", out / "db.npy", "--bits", "--c-l", "4", "-o", out / "b.vprdb"});
  for (const std::string method : {"fastable", "lsh"}) {
    const Json json = printed_json(
        "vpr-query", {out / "b.vprdb", "--query-npy", out / "q.npy", "--c-l", "4", "--t-r", "3",
                      "--t-r-scale", "bits", "--method", method, "--json"});
    CHECK(json["totals"]["recognitions"] == 17);
  }
  check_failure(query({"--c-l", "4", "--method", "lsh", "--t-r", "3", "--t-r-scale", "bits"}), 2,
                "lsh needs raw distances of binary descriptors");
}

TEST_CASE("imported descriptors can be used in data sets, lists and folders") {
  const TemporaryFolder out;
  const auto values = read_array<float>(arrays().path("db.npy"));
  for (const char* name : {"train", "query"}) {
    fs::create_directory(out / name);
    for (size_t i = 0; i < 12; ++i)
      write_array(out / name / fmt::format("{}.npy", i),
                  std::vector<float>(values.begin() + ptrdiff_t(i * kLength),
                                     values.begin() + ptrdiff_t((i + 1) * kLength)),
                  {kLength});
  }
  run_ok("vpr-train", {"descriptors", "--npy", out / "train", "--c-l", "3", "-o", out / "f.vprdb"});
  const Json json = printed_json("vpr-query", {out / "f.vprdb", "--query-npy", out / "query",
                                               "--c-l", "3", "--t-r", "0.01", "--json"});
  CHECK(json["totals"]["recognitions"] == 10);
}

TEST_CASE("exported descriptors have the same distances after import") {
  const TemporaryFolder out;
  const auto distances = [&](const std::string& database, const std::string& query) {
    run_ok("vpr-query", {database, "--query", query, "--c-l", "1", "--t-r", "0.1", "--save-matrix",
                         out / "d.npy", "--force", "--quiet"});
    return read_array<int32_t>(out / "d.npy");
  };
  const auto exported = [&](const std::string& database, const std::string& name) {
    run_ok("vpr-train", {"export", database, "--descriptors", out / name});
    return (out / name).string();
  };
  const auto imported = [&](const std::string& array, const Words& flags) {
    run_ok("vpr-train",
           joined({"descriptors", "--npy", array, "-o", array + ".vprdb", "--quiet"}, flags));
    return array + ".vprdb";
  };
  const std::string one = world().walk("one");
  const std::string back = world().walk("back");
  for (const std::string kind : {"ldb", "hog"}) {
    for (const auto& [name, frames] : {std::pair("one", one), std::pair("back", back)})
      run_ok("vpr-train", {"fastable", "--train", frames, "--descriptor", kind, "-o",
                           out / (kind + name + ".vprdb"), "--quiet"});
    const std::string train = exported(out / (kind + "one.vprdb"), kind + "one.npy");
    const std::string query = exported(out / (kind + "back.vprdb"), kind + "back.npy");
    const Words flags = kind == "ldb" ? Words{"--bits"} : Words{"--value-bits", "8"};
    CHECK(distances(out / (kind + "one.vprdb"), back) == distances(imported(train, flags), query));
  }
  exported(arrays().database(), "vectors.npy");
  CHECK(NpyArray(out / "vectors.npy").shape() == std::vector<size_t>{60, kLength});
  const auto export_it = [&](Words words) {
    return run_program("vpr-train", joined({"export"}, words));
  };
  check_failure(export_it({arrays().database()}), 2, "--descriptors");
  check_failure(export_it({arrays().database(), "--descriptors", out / "vectors.npy"}), 2,
                "vectors.npy");
  check_failure(export_it({world().fabmap(), "--descriptors", out / "x.npy"}), 4, "fabmap");
}

TEST_CASE("descriptors are evaluated without a database, up to recall@100") {
  const TemporaryFolder out;
  const std::vector<float> train = random_rows(150, 8);
  const std::vector<float> noise = random_rows(150, 9);
  std::vector<float> query;
  for (size_t i = 0; i < noise.size(); ++i) query.push_back(0.2F * train[i] + noise[i]);
  write_array(out / "db.npy", train, {150, kLength});
  write_array(out / "q.npy", query, {150, kLength}, true);
  const Json report = printed_json(
      "vpr-eval", {"matrix", "--query-npy", out / "q.npy", "--train-npy", out / "db.npy",
                   "--recall-at", "5,10,100", "--ground-truth", "aligned", "--tolerance", "0",
                   "--html", out / "page.html", "--json"});
  // The definition, product by product.
  std::map<size_t, double> expected;
  for (size_t q = 0; q < 150; ++q) {
    std::vector<double> distances;
    for (size_t i = 0; i < 150; ++i) {
      double product = 0;
      double square = 0;
      for (size_t x = 0; x < kLength; ++x) {
        product += double{query[q * kLength + x]} * train[i * kLength + x];
        square += double{train[i * kLength + x]} * train[i * kLength + x];
      }
      distances.push_back(-product / std::sqrt(square));
    }
    size_t rank = 1;
    for (size_t i = 0; i < 150; ++i) rank += distances[i] < distances[q] ? 1 : 0;
    for (const size_t k : {1, 5, 10, 100}) expected[k] += rank <= k ? 1.0 / 150 : 0;
  }
  const Json& found = report["metrics"]["recall_at"];
  CHECK(found.size() == 4);
  for (const auto& [k, recall] : expected)
    CHECK(found[std::to_string(k)].get<double>() == Approx(recall));
  CHECK(expected[1] < expected[100]);
  CHECK(fs::file_size(out / "page.html") > 10'000);
}

TEST_CASE("descriptors without a database must match each other") {
  const TemporaryFolder out;
  const std::string db = arrays().path("db.npy");
  write_array(out / "short.npy", std::vector<float>(40, 1), {4, 10});
  write_array<uint8_t>(out / "bits.npy", {1, 2, 3, 7, 1, 4}, {3, 2});
  write_array<uint8_t>(out / "wide.npy", {1, 2, 3, 7, 1, 2}, {2, 3});
  const auto evaluate = [&](Words words) {
    return run_program("vpr-eval", joined(words, {"--ground-truth", "aligned", "--json"}));
  };
  const Json bits = printed_json(
      evaluate({"matrix", "--query-npy", out / "bits.npy", "--train-npy", out / "bits.npy"}));
  CHECK(bits["metrics"]["recall_at"]["1"] == 1.0);
  check_failure(evaluate({"matrix", "--query-npy", db, "--train-npy", out / "short.npy"}), 4,
                "the array is 60 x 48, but ");
  check_failure(
      evaluate({"matrix", "--query-npy", out / "bits.npy", "--train-npy", out / "wide.npy"}), 4,
      "is an array transposed?");
  check_failure(evaluate({"matrix", "--query-npy", db, "--train-npy", out / "bits.npy"}), 4,
                "type <f4");
  check_failure(evaluate({"matrix", "--query-npy", db, "--train-npy", world().walk("back")}), 4,
                "is not a .npy file of descriptors");
  check_failure(evaluate({"matrix", "--query-npy", db}), 2, "go together");
  check_failure(evaluate({"matrix", "--query-npy", db, "--train-npy", db, "--similarity"}), 2,
                "--similarity is for SCORES");
  check_failure(evaluate({"matrix", "--query-npy", db, "--train-npy", db, "--recall-at", "0"}), 2,
                "--recall-at must be 1");
  std::vector<float> values(12, 1);
  values[7] = std::numeric_limits<float>::quiet_NaN();
  write_array(out / "nan.npy", values, {4, 3});
  check_failure(
      evaluate({"matrix", "--query-npy", out / "nan.npy", "--train-npy", out / "nan.npy"}), 4,
      "nan.npy: row 2: value 1 is nan");
}

TEST_CASE("frames can have other built-in descriptors") {
  const TemporaryFolder out;
  const std::string one = world().walk("one");
  for (const std::string name : {"thumbnail", "hog", "ldb+hog"}) {
    run_ok("vpr-train", {"fastable", "--train", one, "--descriptor", name, "--c-l", "5", "-o",
                         out / (name + ".vprdb")});
    const Json json =
        printed_json("vpr-query", {out / (name + ".vprdb"), "--query", world().walk("back"),
                                   "--c-l", "5", "--t-r", "0.5", "--verify", "50", "--json"});
    CHECK(json["verification"]["differences"] == 0);
    CHECK(json["totals"]["recognitions"] > 0);
  }
  check_failure("vpr-train",
                {"fastable", "--train", one, "--descriptor", "thumb", "-o", out / "x.vprdb"}, 2,
                "choose one of ldb, thumbnail, hog, ldb+hog");
}

TEST_CASE("raw distances use LDB alone if frames also have HOG vectors") {
  const TemporaryFolder out;
  std::vector<std::string> arrays;
  for (const std::string name : {"ldb", "ldb+hog"}) {
    const std::string database = out / (name + ".vprdb");
    run_ok("vpr-train", {"fastable", "--train", world().walk("one"), "--train",
                         world().walk("back"), "--descriptor", name, "--c-l", "5", "-o", database});
    const std::string result = out / (name + ".json");
    run_ok("vpr-query", {database, "--query", world().walk("back"), "--c-l", "5", "--t-r", "auto",
                         "--save-matrix", out / (name + ".npy"), "-o", result});
    arrays.push_back(read_text(out / (name + ".npy")) + read_text(out / (name + ".best.npy")) +
                     read_text(out / (name + ".recognitions.npy")));
  }
  CHECK(arrays[0] == arrays[1]);
}

TEST_CASE("chords distinguish frames that are closer than the unit of cosine distances") {
  // A thousandth of a radian between frames: its 1 - cos is a sixtieth of a unit.
  const TemporaryFolder out;
  std::vector<double> train;
  std::vector<double> query;
  for (size_t i = 0; i < 30; ++i) {
    const double angle = 0.001 * static_cast<double>(i * 7 % 30);
    for (size_t x = 0; x < 12; ++x) {
      train.push_back(x % 2 == 0 ? std::cos(angle) : std::sin(angle));
      query.push_back(train.back() * static_cast<double>(i + 1));  // lengths have no effect
    }
  }
  write_array(out / "db.npy", train, {30, 12});
  write_array(out / "q.npy", query, {30, 12});
  for (const auto& [metric, least] : {std::pair("chord", 1.0), std::pair("cosine", 0.0)}) {
    INFO(metric);
    const auto trained =
        run_ok("vpr-train", {"descriptors", "--npy", out / "db.npy", "--metric", metric, "--c-l",
                             "3", "-o", out / "db.vprdb", "--force"});
    CHECK(has(trained.err, "Use --metric chord") == (least == 0));
    const Json result = printed_json(
        "vpr-query", {out / "db.vprdb", "--query-npy", out / "q.npy", "--c-l", "1", "--t-r", "0.2",
                      "--verify", "50", "-o", out / "r.json", "--json", "--force"});
    CHECK(result["verification"]["differences"] == 0);
    const Json report = printed_json(
        "vpr-eval", {out / "r.json", "--ground-truth", "aligned", "--tolerance", "0", "--json"});
    const auto right = report["best_match"]["rate"].get<double>();
    CHECK((least == 1 ? right == 1 : right < 0.5));
    // In float64 both orders are equal.
    CHECK(printed_json("vpr-eval", {"matrix", "--query-npy", out / "q.npy", "--train-npy",
                                    out / "db.npy", "--metric", metric, "--ground-truth", "aligned",
                                    "--tolerance", "0", "--json"})["metrics"]["recall_at"]["1"] ==
          1.0);
  }
  run_ok("vpr-train", {"descriptors", "--npy", out / "q.npy", "--metric", "chord", "--c-l", "3",
                       "-o", out / "far.vprdb"});
  CHECK(printed_json("vpr-train", {"info", out / "far.vprdb", "--json"})["descriptor"] ==
        "directions");
  // Exported vectors have length 1.
  run_ok("vpr-train", {"export", out / "far.vprdb", "--descriptors", out / "x.npy"});
  const auto values = read_array<float>(out / "x.npy");
  for (size_t i = 0; i < values.size(); ++i)
    CHECK(std::abs(values[i] - train[i] / std::sqrt(6)) < 1.0 / 32000);
  std::fill_n(query.begin(), 12, 0.0);
  write_array(out / "zero.npy", query, {30, 12});
  check_failure("vpr-query",
                {out / "far.vprdb", "--query-npy", out / "zero.npy", "--c-l", "3", "--t-r", "0.2"},
                4, "row 0: is a vector of zeros");
}

TEST_CASE("vectors with lengths are compared by Euclidean distances") {
  // Train and query have equal directions: places differ only in length.
  const TemporaryFolder out;
  RandomEngine engine(9);
  std::vector<double> train;
  std::vector<double> query;
  for (size_t i = 0; i < 30; ++i) {
    const double length = 1 + 0.1 * static_cast<double>(i * 7 % 30);
    for (size_t x = 0; x < 12; ++x) {
      const double direction = std::cos(static_cast<double>(x));
      train.push_back(length * direction);
      query.push_back(length * direction + 0.001 * (uniform_unit(engine) - 0.5));
    }
  }
  write_array(out / "db.npy", train, {30, 12});
  write_array(out / "q.npy", query, {30, 12});
  run_ok("vpr-train", {"descriptors", "--npy", out / "db.npy", "--metric", "l2", "--c-l", "3", "-o",
                       out / "db.vprdb"});
  const Json info = printed_json("vpr-train", {"info", out / "db.vprdb", "--json"});
  CHECK(info["descriptor"] == "points");
  const Json result =
      printed_json("vpr-query", {out / "db.vprdb", "--query-npy", out / "q.npy", "--c-l", "3",
                                 "--t-r", "0.2", "--verify", "50", "-o", out / "r.json", "--json"});
  CHECK(result["verification"]["differences"] == 0);
  CHECK(printed_json("vpr-eval", {out / "r.json", "--ground-truth", "aligned", "--tolerance", "0",
                                  "--json"})["best_match"]["correct"] == 28);
  for (const auto& [metric, least] : {std::pair("l2", 1.0), std::pair("cosine", 0.0)}) {
    const Json report =
        printed_json("vpr-eval", {"matrix", "--query-npy", out / "q.npy", "--train-npy",
                                  out / "db.npy", "--metric", metric, "--ground-truth", "aligned",
                                  "--tolerance", "0", "--json"});
    const auto recall = report["metrics"]["recall_at"]["1"].get<double>();
    CHECK(recall >= least);
    CHECK((recall == 1) == (least == 1));
  }
  // Exported vectors equal the imported ones up to half a unit.
  run_ok("vpr-train", {"export", out / "db.vprdb", "--descriptors", out / "x.npy"});
  const auto values = read_array<float>(out / "x.npy");
  const double longest = 3.9 * std::sqrt(6.2);
  for (size_t i = 0; i < values.size(); ++i)
    CHECK(std::abs(values[i] - train[i]) < longest / 32000);
  // Added vectors use the same unit, and much longer ones are refused.
  run_ok("vpr-train",
         {"add", out / "db.vprdb", "--train", out / "q.npy", "-o", out / "more.vprdb"});
  for (double& number : query) number *= 3;
  write_array(out / "far.npy", query, {30, 12});
  check_failure("vpr-query",
                {out / "db.vprdb", "--query-npy", out / "far.npy", "--c-l", "3", "--t-r", "0.2"}, 4,
                "more than twice as long");
  check_failure("vpr-train",
                {"descriptors", "--npy", out / "db.npy", "--metric", "l2", "--value-bits", "8",
                 "-o", out / "y.vprdb"},
                2, "--value-bits");
  check_failure(
      "vpr-eval",
      {"matrix", out / "db.npy", "--distance", "--metric", "l2", "--ground-truth", "aligned"}, 2,
      "--metric");
}
