#include <catch2/catch.hpp>

#include "bench/bench_tables.h"

using namespace vpr;

namespace {

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
  result.rows.push_back(
      {"cluster", {{"hits", 1e6}}, "set of hits", {68, 67, 69, 66, 70, 5}, {{"places", 3}}, ""});
  return result;
}

}  // namespace

TEST_CASE("rows of one kind stand in one table, what they share in its title") {
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
  CHECK(tables[1].title == "matching: milliseconds per set of hits, hits 1000000");
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
  CHECK(all.columns == std::vector<std::string>{"work", "frames", "c_l", "query_frames", "hits",
                                                "per", "median", "lower quartile", "upper quartile",
                                                "repetitions", "ring", "fps", "times_openable",
                                                "build_s", "recall", "places", "note"});
  CHECK(all.rows.size() == 7);
}
