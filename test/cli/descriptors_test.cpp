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

// 60 training frames, and a query of 24 frames that repeats frames 30 to 53 with small changes and
// other lengths; databases with 8 and 16 bits per value.
void make_arrays() {
  const std::vector<float> train = random_rows(60, 1);
  const std::vector<float> noise = random_rows(24, 2);
  std::vector<float> query;
  for (size_t i = 0; i < noise.size(); ++i)
    query.push_back(0.01F * (train[30 * kLength + i] + 0.3F * noise[i]));
  write_array("db.npy", train, {60, kLength});
  write_array("q.npy", query, {24, kLength}, true);
  std::string names;
  for (int i = 0; i < 60; ++i) names += fmt::format("db/{:03}.jpg\n", i);
  write_text("names.txt", names);
  for (const std::string bits : {"8", "16"})
    run_ok(
        "vpr-train descriptors --npy db.npy --sequence one=0:28 --sequence two=28:60 "
        "--names names.txt --c-l 5 --value-bits " +
        bits + " -o db" + bits + ".vprdb");
}

// Vectors of which one has a value that is not a number.
void write_nan(const std::string& name) {
  std::vector<float> values(12, 1);
  values[7] = std::numeric_limits<float>::quiet_NaN();
  write_array(name, values, {4, 3});
}

RunOutcome query(const std::string& words, const std::string& precision = "8") {
  return run("vpr-query db" + precision + ".vprdb --query-npy q.npy --json " + words);
}

}  // namespace

TEST_CASE("a database of imported descriptors reports its content") {
  start_with(make_arrays);
  const Json narrow = printed_json("vpr-train info db8.vprdb --json");
  CHECK(narrow["descriptor"] == "vectors8");
  CHECK(narrow["length"] == kLength);
  REQUIRE(narrow["sequences"].size() == 2);
  CHECK(narrow["sequences"][1]["name"] == "two");
  CHECK(narrow["sequences"][1]["frames"] == 32);
  const auto text = run("vpr-train info db16.vprdb");
  CHECK(has(text.out, "2 sequences, 60 frames, vectors of 48 numbers"));
  CHECK(read_text("db8.vprdb/frames.txt") == read_text("names.txt"));
}

TEST_CASE("every decision and score supports imported descriptors, and cells are verified") {
  start_with(make_arrays);
  for (const std::string precision : {"8", "16"}) {
    for (const std::string words :
         {"--c-l 5 --t-r auto", "--c-l 5 --t-r 0.5", "--c-l 3 --score zscore --t-r -3",
          "--c-l 5 --score zscore-offline --t-r -3", "--c-l 5 --method openable --t-r 0.5",
          "--c-l 5 --method fastable-online --t-r 0.5", "--c-l 4 --rates 1/2,1,2 --t-r 0.5"}) {
      const bool has_rates = has(words, "--rates");
      INFO(precision << " bits, " << words);
      const Json json = printed_json(query(words + (has_rates ? "" : " --verify 60"), precision));
      CHECK(json["totals"]["recognitions"] > 0);
      CHECK(json.contains("verification") == !has_rates);
      for (const Json& best : json["clusters"]) {
        CHECK(best["sequence"] == 1);
        CHECK(best["train"]["window"].get<int>() == best["query"]["window"].get<int>() + 2);
      }
    }
    const Json margins =
        printed_json(query("--c-l 5 --score zscore --decide margin --margin 0.5", precision));
    CHECK(margins["totals"]["recognitions"] > 10);
    const Json filtered = printed_json(query("--method filter --margin 1", precision));
    CHECK(filtered["settings"]["method"] == "filter");
  }
}

TEST_CASE("imported descriptors are evaluated and swept like others") {
  start_with(make_arrays);
  run_ok("vpr-train descriptors --npy db.npy@30:54 --c-l 5 -o part.vprdb");
  run_ok("vpr-query part.vprdb --query q.npy --c-l 5 --t-r 0.5 -o r.json");
  const Json report =
      printed_json("vpr-eval r.json --ground-truth aligned --tolerance 0 --html r.html --json");
  CHECK(report["best_match"]["correct"] == 20);  // all frames at which a window ends
  CHECK(report["best_match"]["frames"] == 24);
  check_failure("vpr-eval r.json --ground-truth aligned --query q.npy --html r2.html", 2,
                "plots need its images");
  const Json sweep = printed_json(
      "vpr-tune fastable part.vprdb --query q.npy --ground-truth aligned --c-l 1,5 --json");
  CHECK(has(sweep.dump(), "recommend"));
}

TEST_CASE("more sequences can be added, with the same descriptors only") {
  start_with(make_arrays);
  run_ok("vpr-train add db8.vprdb --train q.npy -o more.vprdb");
  write_array("short.npy", std::vector<float>(40, 1), {4, 10});
  check_failure("vpr-train add db8.vprdb --train short.npy -o x.vprdb", 4,
                "short.npy: its descriptors have 10 numbers, descriptors of the database 48");
  check_failure("vpr-query db8.vprdb --query-npy short.npy --c-l 2", 4,
                "descriptors of the database have 48 numbers, descriptors of the query 10");
  check_failure("vpr-train descriptors --npy db.npy --npy short.npy -o x.vprdb", 4,
                "10 numbers, descriptors of the database 48");
}

TEST_CASE("images and descriptors of another kind are refused with the reason") {
  start_with(make_arrays);
  check_refused("vpr-query",
                {{"db8.vprdb --query $back", 4, "the database has imported descriptors"},
                 {"$db --query-npy q.npy", 4,
                  "holds descriptors, but frames of the database are described by ldb"},
                 {"$fabmap --query-npy q.npy", 4, "images are needed"},
                 {"db8.vprdb --query-npy $back", 2, "is not a .npy file"},
                 {"db8.vprdb --query-npy q.npy --query $back", 2,
                  "--query-npy cannot be combined with --query"}});
  write_text("few.txt", "a\nb\n");
  write_nan("nan.npy");
  write_text("cut.npy", read_text("db.npy").substr(0, 1000));
  std::vector<float> gap = random_rows(9, 5);
  std::fill_n(gap.begin(), kLength, std::numeric_limits<float>::quiet_NaN());
  write_array("gap.npy", gap, {9, kLength});
  check_refused(
      "vpr-train descriptors -o x.vprdb",
      {{"", 2, "--npy"},
       {"--npy $back", 2, "is not a .npy file"},
       {"--npy missing.npy", 3, "missing.npy"},
       {"--npy db.npy --bits", 4, "bits are uint8"},
       {"--npy db.npy --value-bits 12", 2, "16 or 8"},
       {"--npy db.npy --bits --value-bits 8", 2, "have no effect on --bits"},
       {"--npy db.npy --sequence a", 2, "NAME=FIRST:LAST"},
       {"--npy db.npy --sequence a=b", 2, "NAME=FIRST:LAST"},
       {"--npy db.npy --sequence a=0:61", 2, "exceeds"},
       {"--npy db.npy --sequence a=0:9 --sequence a=9:20", 2, "two sequences have the name a"},
       {"--npy db.npy --npy db.npy@0:9 --sequence a=0:9", 2, "a single --npy"},
       {"--npy db.npy --names few.txt", 4, "few.txt: names 2 frames"},
       {"--npy nan.npy", 4, "nan.npy: row 2: value 1 is nan"},
       {"--npy gap.npy", 4, "row 0 is missing"},
       {"--npy cut.npy", 4, "truncated"}});
  CHECK_FALSE(fs::exists("x.vprdb"));
  run_ok("vpr-train descriptors --npy gap.npy --skip-unreadable -o g.vprdb");
  CHECK(printed_json("vpr-query g.vprdb --query-npy gap.npy --c-l 1 --t-r 0.01 --skip-unreadable "
                     "--json")["totals"]["recognitions"] == 8);
}

TEST_CASE("bits from files match like LDB, also with hashing") {
  start_with(make_arrays);
  RandomEngine engine(7);
  std::vector<uint8_t> codes(50 * 9);
  for (uint8_t& byte : codes) byte = static_cast<uint8_t>(uniform_below(engine, 256));
  write_array("codes.npy", codes, {50, 9});
  const std::vector<uint8_t> part(codes.begin() + 20 * 9, codes.begin() + 40 * 9);
  write_array("part.npy", part, {20, 9}, true);
  run_ok("vpr-train descriptors --npy codes.npy --bits --c-l 4 -o b.vprdb");
  for (const std::string method : {"fastable", "lsh"}) {
    const Json json = printed_json(
        "vpr-query b.vprdb --query-npy part.npy --c-l 4 --t-r 3 --t-r-scale bits --method " +
        method + " --json");
    CHECK(json["totals"]["recognitions"] == 17);
  }
  check_failure(query("--c-l 4 --method lsh --t-r 3 --t-r-scale bits"), 2,
                "lsh needs raw distances of binary descriptors");
}

TEST_CASE("exported descriptors have the same distances after import") {
  start_with(make_arrays);
  const auto distances = [&](const std::string& database, const std::string& query) {
    run_ok("vpr-query " + database + " --query " + query +
           " --c-l 1 --t-r 0.1 --save-matrix d.npy --force --quiet");
    return read_array<int32_t>("d.npy");
  };
  const auto exported = [&](const std::string& database, const std::string& name) {
    run_ok("vpr-train export " + database + " --descriptors " + name);
    return name;
  };
  const auto imported = [&](const std::string& array, const std::string& flags) {
    run_ok("vpr-train descriptors --npy " + array + " -o " + array + ".vprdb --quiet " + flags);
    return array + ".vprdb";
  };
  for (const std::string kind : {"ldb", "hog"}) {
    for (const std::string walk : {"one", "back"})
      run_ok("vpr-train fastable --train $" + walk + " --descriptor " + kind + " -o " + kind +
             walk + ".vprdb --quiet");
    const std::string train = exported(kind + "one.vprdb", kind + "one.npy");
    const std::string query = exported(kind + "back.vprdb", kind + "back.npy");
    const std::string flags = kind == "ldb" ? "--bits" : "--value-bits 8";
    CHECK(distances(kind + "one.vprdb", "$back") == distances(imported(train, flags), query));
  }
  exported("db8.vprdb", "vectors.npy");
  CHECK(NpyArray("vectors.npy").shape() == std::vector<size_t>{60, kLength});
  check_refused("vpr-train export", {{"db8.vprdb", 2, "--descriptors"},
                                     {"db8.vprdb --descriptors vectors.npy", 2, "vectors.npy"},
                                     {"$fabmap --descriptors x.npy", 4, "fabmap"}});
}

TEST_CASE("descriptors are evaluated without a database, up to recall@100") {
  const std::vector<float> train = random_rows(150, 8);
  const std::vector<float> noise = random_rows(150, 9);
  std::vector<float> query;
  for (size_t i = 0; i < noise.size(); ++i) query.push_back(0.2F * train[i] + noise[i]);
  write_array("db.npy", train, {150, kLength});
  write_array("q.npy", query, {150, kLength}, true);
  const Json report = printed_json(
      "vpr-eval matrix --query-npy q.npy --train-npy db.npy --recall-at 5,10,100 --ground-truth "
      "aligned --tolerance 0 --html page.html --json");
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
  CHECK(fs::file_size("page.html") > 10'000);
}

TEST_CASE("descriptors without a database must match each other") {
  start_with(make_arrays);
  write_array("short.npy", std::vector<float>(40, 1), {4, 10});
  write_array<uint8_t>("bits.npy", {1, 2, 3, 7, 1, 4}, {3, 2});
  write_array<uint8_t>("wide.npy", {1, 2, 3, 7, 1, 2}, {2, 3});
  write_nan("nan.npy");
  const std::string evaluate = "vpr-eval matrix --ground-truth aligned --json --query-npy";
  const Json bits = printed_json(evaluate + " bits.npy --train-npy bits.npy");
  CHECK(bits["metrics"]["recall_at"]["1"] == 1.0);
  check_refused(evaluate,
                {{"db.npy --train-npy short.npy", 4, "the array is 60 x 48, but "},
                 {"bits.npy --train-npy wide.npy", 4, "is an array transposed?"},
                 {"db.npy --train-npy bits.npy", 4, "type <f4"},
                 {"db.npy --train-npy $back", 4, "is not a .npy file of descriptors"},
                 {"db.npy", 2, "go together"},
                 {"db.npy --train-npy db.npy --similarity", 2, "--similarity is for SCORES"},
                 {"db.npy --train-npy db.npy --recall-at 0", 2, "--recall-at must be 1"},
                 {"nan.npy --train-npy nan.npy", 4, "nan.npy: row 2: value 1 is nan"}});
}

TEST_CASE("frames can have other built-in descriptors") {
  for (const std::string name : {"thumbnail", "hog", "ldb+hog"}) {
    run_ok("vpr-train fastable --train $one --descriptor " + name + " --c-l 5 -o " + name +
           ".vprdb");
    const Json json = printed_json("vpr-query " + name +
                                   ".vprdb --query $back --c-l 5 --t-r 0.5 --verify 50 --json");
    CHECK(json["verification"]["differences"] == 0);
    CHECK(json["totals"]["recognitions"] > 0);
  }
  check_failure("vpr-train fastable --train $one --descriptor thumb -o x.vprdb", 2,
                "choose one of ldb, thumbnail, hog, ldb+hog");
}

TEST_CASE("chords distinguish frames that are closer than the unit of cosine distances") {
  // A thousandth of a radian between frames: its 1 - cos is a sixtieth of a unit.
  std::vector<double> train;
  std::vector<double> query;
  for (size_t i = 0; i < 30; ++i) {
    const double angle = 0.001 * static_cast<double>(i * 7 % 30);
    for (size_t x = 0; x < 12; ++x) {
      train.push_back(x % 2 == 0 ? std::cos(angle) : std::sin(angle));
      query.push_back(train.back() * static_cast<double>(i + 1));  // lengths have no effect
    }
  }
  write_array("db.npy", train, {30, 12});
  write_array("q.npy", query, {30, 12});
  for (const auto& [metric, least] : std::map<std::string, double>{{"chord", 1}, {"cosine", 0}}) {
    INFO(metric);
    const auto trained = run_ok("vpr-train descriptors --npy db.npy --metric " + metric +
                                " --c-l 3 -o db.vprdb --force");
    CHECK(has(trained.err, "Use --metric chord") == (least == 0));
    const Json result = printed_json(
        "vpr-query db.vprdb --query-npy q.npy --c-l 1 --t-r 0.2 --verify 50 -o r.json --json "
        "--force");
    CHECK(result["verification"]["differences"] == 0);
    const Json report = printed_json("vpr-eval r.json --ground-truth aligned --tolerance 0 --json");
    const auto right = report["best_match"]["rate"].get<double>();
    CHECK((least == 1 ? right == 1 : right < 0.5));
    // In float64 both orders are equal.
    CHECK(printed_json(
              "vpr-eval matrix --query-npy q.npy --train-npy db.npy --metric " + metric +
              " --ground-truth aligned --tolerance 0 --json")["metrics"]["recall_at"]["1"] == 1.0);
  }
  run_ok("vpr-train descriptors --npy q.npy --metric chord --c-l 3 -o far.vprdb");
  CHECK(printed_json("vpr-train info far.vprdb --json")["descriptor"] == "directions");
}

TEST_CASE("vectors with lengths are compared by Euclidean distances") {
  // Train and query have equal directions: places differ only in length.
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
  write_array("db.npy", train, {30, 12});
  write_array("q.npy", query, {30, 12});
  run_ok("vpr-train descriptors --npy db.npy --metric l2 --c-l 3 -o db.vprdb");
  const Json info = printed_json("vpr-train info db.vprdb --json");
  CHECK(info["descriptor"] == "points");
  const Json result = printed_json(
      "vpr-query db.vprdb --query-npy q.npy --c-l 3 --t-r 0.2 --verify 50 -o r.json --json");
  CHECK(result["verification"]["differences"] == 0);
  CHECK(
      printed_json(
          "vpr-eval r.json --ground-truth aligned --tolerance 0 --json")["best_match"]["correct"] ==
      28);
  for (const auto& [metric, least] : std::map<std::string, double>{{"l2", 1}, {"cosine", 0}}) {
    const Json report =
        printed_json("vpr-eval matrix --query-npy q.npy --train-npy db.npy --metric " + metric +
                     " --ground-truth aligned --tolerance 0 --json");
    const auto recall = report["metrics"]["recall_at"]["1"].get<double>();
    CHECK(recall >= least);
    CHECK((recall == 1) == (least == 1));
  }
  // Exported vectors equal the imported ones up to half a unit.
  run_ok("vpr-train export db.vprdb --descriptors x.npy");
  const auto values = read_array<float>("x.npy");
  const double longest = 3.9 * std::sqrt(6.2);
  for (size_t i = 0; i < values.size(); ++i)
    CHECK(std::abs(values[i] - train[i]) < longest / 32000);
  // Added vectors use the same unit, and much longer ones are refused.
  run_ok("vpr-train add db.vprdb --train q.npy -o more.vprdb");
  for (double& number : query) number *= 3;
  write_array("far.npy", query, {30, 12});
  check_failure("vpr-query db.vprdb --query-npy far.npy --c-l 3 --t-r 0.2", 4,
                "more than twice as long");
  check_failure("vpr-train descriptors --npy db.npy --metric l2 --value-bits 8 -o y.vprdb", 2,
                "--value-bits");
  check_failure("vpr-eval matrix db.npy --distance --metric l2 --ground-truth aligned", 2,
                "--metric");
}
