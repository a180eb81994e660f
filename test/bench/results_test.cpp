// Results of vpr-bench: measurement, comparison and output.
#include <atomic>

#include <catch2/catch.hpp>

#include "base/json.h"
#include "bench/bench_result.h"
#include "bench/generated.h"
#include "reference/reference.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

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

BenchRow make_row(const std::string& work, double frames, double c_l, NamedNumbers values,
                  const std::string& note = "") {
  return {work,
          {{"frames", frames}, {"c_l", c_l}, {"query_frames", 1000}},
          "query frame",
          {0.0023456, 0.0021456, 0.0031456, 0.002, 0.004, 10000},
          std::move(values),
          note};
}

BenchResult make_result() {
  BenchResult result;
  result.bench = "matching";
  for (const double c_l : {20, 80})
    result.rows.insert(
        result.rows.end(),
        {make_row("fastable", 8000, c_l,
                  {{"ring", 1}, {"fps", 426330.1}, {"times_openable", 71.2345}}),
         make_row("openable", 8000, c_l, {{"fps", 42}}, "12 cells of a row sampled"),
         make_row("lsh", 8000, c_l, {{"build_s", 3.25}, {"recall", 0.989}, {"fps", 42}})});
  result.rows.push_back({"cluster",
                         {{"recognitions", 1e6}},
                         "set of recognitions",
                         {68, 67, 69, 66, 70, 5},
                         {{"places", 3}},
                         ""});
  return result;
}

}  // namespace

TEST_CASE("a summary equals the closed forms of evenly spaced values") {
  // 1, 2, ..., n: the p-quantile is 1 + p (n - 1).
  for (const size_t n : {1, 2, 5, 100, 101}) {
    std::vector<double> values;
    for (size_t i = n; i > 0; --i) values.push_back(static_cast<double>(i));
    const TimeSummary summary = summarize(values);
    const auto last = static_cast<double>(n);
    CHECK(summary.median_ms == Approx(1 + 0.5 * (last - 1)));
    CHECK(summary.lower_quartile_ms == Approx(1 + 0.25 * (last - 1)));
    CHECK(summary.upper_quartile_ms == Approx(1 + 0.75 * (last - 1)));
    CHECK(summary.least_ms == 1);
    CHECK(summary.most_ms == last);
    CHECK(summary.repetitions == n);
  }
}

TEST_CASE("work is repeated the minimum number of times and the minimum time, but not more") {
  size_t runs = 0;
  const auto count = [&] { ++runs; };
  CHECK(time_repeatedly({0, 7, 100}, count, {}).repetitions == 7);
  CHECK(runs == 8);  // the first is not timed
  CHECK(time_repeatedly({1000, 1, 12}, count, {}).repetitions == 12);
}

TEST_CASE("a stop ends a measurement") {
  const std::atomic<bool> stop = true;
  Monitor monitor;
  monitor.stop = &stop;
  CHECK(error_kind([&] {
          time_repeatedly(
              {}, [] {}, monitor);
        }) == ErrorKind::interrupted);
}

TEST_CASE("generated sequences change little between frames, and more between days") {
  const auto walk = generate_sequence(200, 1);
  CHECK(walk == generate_sequence(200, 1));
  CHECK(walk != generate_sequence(200, 2));
  const auto again = repeat_sequence(walk, 50, 100, 150, 3);
  for (size_t i = 0; i + 1 < 100; ++i) {
    CHECK(reference_hamming(walk[i], walk[i + 1]) > 20);
    CHECK(reference_hamming(walk[i], walk[i + 1]) <= 60);
    CHECK(reference_hamming(walk[50 + i], again[i]) > 80);
    CHECK(reference_hamming(walk[50 + i], again[i]) <= 150);
  }
  CHECK(reference_hamming(walk[0], walk[199]) > 500);
}

TEST_CASE("ratios and their quartiles equal values computed by hand") {
  const BenchComparison comparison = compare_benches(make_run(1), make_run(2));
  REQUIRE(comparison.ratios.size() == 2);
  CHECK(comparison.ratios[0].ratio == 2);
  CHECK(comparison.ratios[0].low == Approx(6.0 / 5));
  CHECK(comparison.ratios[0].high == Approx(10.0 / 3));
  CHECK(comparison.ratios[1].ratio == 1);
  CHECK(count_slower(comparison, 1.5) == 1);
  CHECK(count_slower(comparison, 2) == 0);  // strict bound
  CHECK(count_slower(comparison, 0.9) == 2);
}

TEST_CASE("a ratio whose quartiles include 1 is not significant") {
  BenchResult newer = make_run(1.9);  // median ratio 1.9, lowest ratio 5.7 / 5 = 1.14
  CHECK(count_slower(compare_benches(make_run(1), newer), 1.2) == 1);
  newer.rows[0].time.lower_quartile_ms = 4.9;  // lowest ratio 0.98
  const BenchComparison comparison = compare_benches(make_run(1), newer);
  CHECK(count_slower(comparison, 1.2) == 0);
  CHECK(comparison_table(comparison, 1.2).rows[0].back() == "unsure");
  CHECK(comparison_json(comparison, 1.2)["rows"][0]["slower"] == false);
}

TEST_CASE("rows in only one run are listed; runs without common rows are refused") {
  BenchResult older = make_run(1);
  BenchResult newer = make_run(1);
  older.rows[0].work = "openable";
  newer.rows[0].parameters[0].value = 5;
  const BenchComparison comparison = compare_benches(older, newer);
  CHECK(comparison.ratios.size() == 1);
  CHECK(comparison.only_in_one.size() == 2);
  newer.rows.pop_back();
  CHECK(error_kind([&] { compare_benches(older, newer); }) == ErrorKind::data);
  newer.bench = "fabmap";
  CHECK(error_kind([&] { compare_benches(older, newer); }) == ErrorKind::data);
}

TEST_CASE("a stored run can be read back; a damaged one is refused") {
  const BenchResult run = make_run(1);
  Json json = bench_json(run, {});
  write_text("b.json", json.dump());
  const BenchResult read = read_bench("b.json");
  CHECK(read.bench == run.bench);
  REQUIRE(read.rows.size() == run.rows.size());
  for (size_t i = 0; i < run.rows.size(); ++i) {
    CHECK(read.rows[i].work == run.rows[i].work);
    CHECK(read.rows[i].parameters == run.rows[i].parameters);
    CHECK(read.rows[i].time.median_ms == run.rows[i].time.median_ms);
  }
  const auto kind_of = [&](const std::string& text) {
    write_text("b.json", text);
    return error_kind([&] { read_bench("b.json"); });
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

TEST_CASE("rows of one kind form one table, with their common parts in its title") {
  const std::vector<Table> tables = readable_tables(make_result());
  REQUIRE(tables.size() == 2);
  CHECK(tables[0].title ==
        "matching: milliseconds per query frame, frames 8000, query frames 1000");
  CHECK(tables[0].columns ==
        std::vector<std::string>{"work", "c_l", "median", "quartiles", "runs", "fps", ""});
  REQUIRE(tables[0].rows.size() == 6);
  CHECK(tables[0].rows[0] == std::vector<std::string>{"fastable", "20", "0.002346",
                                                      "0.002146 to 0.003146", "10000", "426330",
                                                      "x OpenABLE 71.2"});
  CHECK(tables[0].rows[2].back() == "build s 3.25, recall 0.989");
  CHECK(tables[1].title == "matching: milliseconds per set of recognitions, recognitions 1000000");
  CHECK(tables[1].columns ==
        std::vector<std::string>{"work", "median", "quartiles", "runs", "places"});
}

TEST_CASE("tables for people fit 120 columns; the one for programs has every column") {
  for (const Table& table : readable_tables(make_result())) {
    const std::string text = render_table(table, TableFormat::text);
    for (size_t begin = 0; begin < text.size();) {
      const size_t end = text.find('\n', begin);
      CHECK(end - begin <= 120);
      begin = end + 1;
    }
  }
  const Table all = rows_table(make_result());
  CHECK(all.columns == std::vector<std::string>{
                           "work", "frames", "c_l", "query_frames", "recognitions", "per", "median",
                           "lower quartile", "upper quartile", "repetitions", "ring", "fps",
                           "times_openable", "build_s", "recall", "places", "note"});
  CHECK(all.rows.size() == 7);
}
