#include "bench/compare.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/json.h"
#include "bench/bench_file.h"
#include "support.h"

using namespace vpr;

namespace {

BenchResult make_run(double factor) {
  BenchResult run;
  run.bench = "matching";
  run.settings = Json::object();
  run.rows.push_back({"fastable",
                      {{"frames", 1000}},
                      "query frame",
                      {4 * factor, 3 * factor, 5 * factor, 1 * factor, 9 * factor, 50},
                      {},
                      ""});
  run.rows.push_back({"fastable", {{"frames", 2000}}, "query frame", {8, 8, 8, 8, 8, 50}, {}, ""});
  return run;
}

}  // namespace

TEST_CASE("ratios and their spread, worked out by hand") {
  const BenchComparison comparison = compare_benches(make_run(1), make_run(2));
  REQUIRE(comparison.ratios.size() == 2);
  CHECK(comparison.ratios[0].ratio == 2);
  CHECK(comparison.ratios[0].low == Approx(6.0 / 5));
  CHECK(comparison.ratios[0].high == Approx(10.0 / 3));
  CHECK(comparison.ratios[1].ratio == 1);
  CHECK(count_slower(comparison, 1.5) == 1);
  CHECK(count_slower(comparison, 2) == 0);  // strict
  CHECK(count_slower(comparison, 0.9) == 2);
}

TEST_CASE("a ratio whose spread holds 1 proves nothing") {
  BenchResult newer = make_run(1.9);  // 1.9 in the middle, 5.7 / 5 = 1.14 at the least
  CHECK(count_slower(compare_benches(make_run(1), newer), 1.2) == 1);
  newer.rows[0].time.lower_quartile_ms = 4.9;  // 0.98 at the least
  const BenchComparison comparison = compare_benches(make_run(1), newer);
  CHECK(count_slower(comparison, 1.2) == 0);
  CHECK(comparison_table(comparison, 1.2).rows[0].back() == "unsure");
  CHECK(comparison_json(comparison, 1.2)["rows"][0]["slower"] == false);
}

TEST_CASE("rows without a partner are named; runs with none in common are refused") {
  BenchResult older = make_run(1);
  BenchResult newer = make_run(1);
  older.rows[0].work = "openable";
  newer.rows[0].parameters[0].second = 5;
  const BenchComparison comparison = compare_benches(older, newer);
  CHECK(comparison.ratios.size() == 1);
  CHECK(comparison.only_in_one.size() == 2);
  newer.rows.pop_back();
  CHECK(test::error_kind([&] { compare_benches(older, newer); }) == ErrorKind::data);
  newer.bench = "fabmap";
  CHECK(test::error_kind([&] { compare_benches(older, newer); }) == ErrorKind::data);
}

TEST_CASE("a stored run is read as it was; a broken one is refused") {
  const test::TemporaryFolder out;
  const BenchResult run = make_run(1);
  Json json = bench_json(run, {});
  test::write_text(out / "b.json", json.dump());
  const BenchResult read = read_bench(out / "b.json");
  CHECK(read.bench == run.bench);
  REQUIRE(read.rows.size() == run.rows.size());
  for (size_t i = 0; i < run.rows.size(); ++i) {
    CHECK(read.rows[i].work == run.rows[i].work);
    CHECK(read.rows[i].parameters == run.rows[i].parameters);
    CHECK(read.rows[i].time.median_ms == run.rows[i].time.median_ms);
  }
  const auto kind_of = [&](const std::string& text) {
    test::write_text(out / "b.json", text);
    return test::error_kind([&] { read_bench(out / "b.json"); });
  };
  CHECK(kind_of("") == ErrorKind::data);
  CHECK(kind_of(json.dump().substr(0, 200)) == ErrorKind::data);
  json["rows"][0]["median_ms"] = "fast";
  CHECK(kind_of(json.dump()) == ErrorKind::data);
  json["rows"][0]["median_ms"] = -1;
  CHECK(kind_of(json.dump()) == ErrorKind::data);
  json["rows"] = 3;
  CHECK(kind_of(json.dump()) == ErrorKind::data);
}
