// Imported descriptors in all programs.
#include <algorithm>
#include <limits>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/random.h"
#include "world.h"

using namespace vpr;
using namespace vpr::test;

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
        "vpr-train descriptors --train db.npy --sequence one=0:28 --sequence two=28:60 "
        "--names names.txt --c-l 5 --value-bits " +
        bits + " -o db" + bits + ".vprdb");
}

RunOutcome query(const std::string& words, const std::string& precision) {
  return run("vpr-query db" + precision + ".vprdb --query q.npy --json " + words);
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
  CHECK(has(text.out, "2 sequences, 60 frames, 48 numbers each (vectors)"));
  CHECK(read_text("db8.vprdb/frames.txt") == read_text("names.txt"));
}

TEST_CASE("every decision and score supports imported descriptors") {
  start_with(make_arrays);
  for (const std::string precision : {"8", "16"}) {
    for (const std::string words :
         {"--c-l 5 --t-r auto", "--c-l 5 --t-r 0.5", "--c-l 3 --score zscore --t-r -3",
          "--c-l 5 --method openable --t-r 0.5", "--c-l 5 --method fastable-online --t-r 0.5"}) {
      INFO(precision << " bits, " << words);
      const Json json = printed_json(query(words, precision));
      CHECK(json["totals"]["recognitions"] > 0);
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
  run_ok("vpr-train descriptors --train db.npy@30:54 --c-l 5 -o part.vprdb");
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

TEST_CASE("sequences can be added, and vectors that are not numbers omitted") {
  start_with(make_arrays);
  run_ok("vpr-train add db8.vprdb --train q.npy -o more.vprdb");
  std::vector<float> gap = random_rows(9, 5);
  std::fill_n(gap.begin(), kLength, std::numeric_limits<float>::quiet_NaN());
  write_array("gap.npy", gap, {9, kLength});
  run_ok("vpr-train descriptors --train gap.npy --skip-unreadable -o g.vprdb");
  CHECK(printed_json("vpr-query g.vprdb --query gap.npy --c-l 1 --t-r 0.01 --skip-unreadable "
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
  run_ok("vpr-train descriptors --train codes.npy --bits --c-l 4 -o b.vprdb");
  for (const std::string method : {"fastable", "lsh"}) {
    const Json json = printed_json(
        "vpr-query b.vprdb --query part.npy --c-l 4 --t-r 3 --t-r-scale bits --method " + method +
        " --json");
    CHECK(json["totals"]["recognitions"] == 17);
  }
  const Json report = printed_json(
      "vpr-eval matrix --query codes.npy --train codes.npy --ground-truth aligned --json");
  CHECK(report["metrics"]["recall_at"]["1"] == 1.0);
}

TEST_CASE("rows of arrays have the names and images of --query-images and --train-images") {
  start_with(make_arrays);
  std::string names;
  for (int i = 0; i < 24; ++i) names += fmt::format("q/{:03}.jpg\n", i);
  write_text("q.txt", names);
  const std::string eval =
      "vpr-eval matrix --query q.npy --train db.npy --query-images q.txt --train-images names.txt ";
  run_ok(eval + "--top-k 1 --pairs pairs.txt");
  CHECK(read_text("pairs.txt").starts_with("q/000.jpg db/030.jpg\nq/001.jpg db/031.jpg\n"));
  // A ground truth of numbers does not use names.
  std::string pairs = "query,reference\n";
  for (int i = 0; i < 24; ++i) pairs += fmt::format("{},{}\n", i, i + 30);
  write_text("pairs.csv", pairs);
  const Json report = printed_json(eval + "--ground-truth pairs.csv --json");
  CHECK(report["metrics"]["recall_at"]["1"] == 1.0);
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
    run_ok("vpr-train descriptors --train " + array + " -o " + array + ".vprdb --quiet " + flags);
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
}

TEST_CASE("frames can have other built-in descriptors") {
  for (const std::string name : {"thumbnail", "hog", "ldb+hog"}) {
    run_ok("vpr-train fastable --train $one --descriptor " + name + " --c-l 5 -o " + name +
           ".vprdb");
    const Json json =
        printed_json("vpr-query " + name + ".vprdb --query $back --c-l 5 --t-r 0.5 --json");
    CHECK(json["totals"]["recognitions"] > 0);
  }
}
