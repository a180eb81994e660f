// Rows of text: separators, quotes, comments, headers, units and errors.
#include "base/rows.h"

#include <numbers>

#include <catch2/catch.hpp>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"
#include "support.h"

using namespace vpr;

namespace {

const RowRules kAnyCells = {.needs_header = false, .is_ragged = true};
const RowRules kList = {{"query", "match", "score"}, 2, false, kListSeparators};

/// "LINE cell|cell / LINE cell|cell"
std::string cells_of(const std::string& text, const RowRules& rules = kAnyCells) {
  test::write_text("rows.csv", text);
  Rows rows("rows.csv", "rows.csv", rules);
  std::vector<std::string> found;
  while (rows.next())
    found.push_back(fmt::format("{} {}", rows.line(), fmt::join(rows.cells(), "|")));
  return fmt::format("{}", fmt::join(found, " / "));
}

std::string refusal(const std::string& text, const RowRules& rules = kAnyCells) {
  CHECK(test::error_kind([&] { cells_of(text, rules); }) == ErrorKind::data);
  return test::error_text([&] { cells_of(text, rules); });
}

}  // namespace

TEST_CASE("cells may be quoted, rows may end in CR LF, empty lines are skipped") {
  CHECK(cells_of("\xef\xbb\xbf"
                 "a,b\r\n\r\n\"x,\"\"y\"\"\",2\n \t\n3 , 4") == "1 a|b / 3 x,\"y\"|2 / 5 3|4");
  CHECK(cells_of("\"two\nlines\",1\n2,3\n") == "1 two\nlines|1 / 3 2|3");
  CHECK(cells_of("").empty());
  CHECK(cells_of("\n# only\n").empty());
}

TEST_CASE("an unterminated quote, or one inside a cell, is refused with the line") {
  for (const char* text : {"1\na,\"b", "1\na\"b,c", "1\n\"a\"b"})
    CHECK(test::has(refusal(text), "rows.csv, line 2: "));
  CHECK(test::has(refusal("a,b\r1,2\r"), "expected a separator or a line feed"));
  CHECK(test::has(refusal(std::string("a\nb\0", 4)), "rows.csv, line 2: it is not text"));
}

TEST_CASE("a CSV field can be read back after writing") {
  for (const std::string text : {"plain", "a,b", "say \"hi\"", "two\nlines", "", "#1", "a ", "\tb"})
    CHECK(cells_of(csv_field(text) + ",x") == "1 " + text + "|x");
}

TEST_CASE("the first row determines the separator") {
  CHECK(cells_of("a b;c,d\n") == "1 a b;c|d");
  CHECK(cells_of("a b;c\td\n1;2,3\n") == "1 a b|c\td / 2 1|2,3");
  CHECK(cells_of("\tb c\n") == "1 |b c");
  CHECK(cells_of("a b\n") == "1 a b");
  RowRules words = kAnyCells;
  words.separators = kListSeparators;
  CHECK(cells_of(" a \t b\n\"c d\"\te f \n", words) == "1 a|b / 2 c d|e f");
  CHECK(cells_of(" a   b\n\"c d\"\te,f \n", words) == "1 a|b / 2 c d|e,f");
  CHECK(cells_of("a,b c\n", words) == "1 a|b c");
}

TEST_CASE("lines that begin with # are comments, unless they are the header of numbers") {
  CHECK(cells_of("# a\n1,2\n #b\n\"#c\",3\n") == "2 1|2 / 4 #c|3");
  const RowRules pairs = {{"query", "reference"}, 2};
  CHECK(cells_of("sep=,\n# by hand\n# reference,query\n1,2\n", pairs) == "4 1|2");
  CHECK(cells_of("sep=;\n# by hand\nreference;query\n1;2\n", pairs) == "4 1|2");
  CHECK(test::has(refusal("# query,reference\na,b\n", pairs), "has no column query"));
  CHECK(cells_of("# match,query\n1,2\n", kList) == "2 1|2");
  CHECK(cells_of("#\nquery,reference\n\"1\"\"\",\"2\"\n", pairs) == "3 1\"|2");
  CHECK(cells_of("# query,reference\n 1,\"2\"\"\"\n", pairs) == "2 1|2\"");
  const RowRules images = {.columns = {"image", "x"}, .needed = 2, .separators = kListSeparators};
  CHECK(cells_of("# my photos\n# image x\na.png 1\n", images) == "3 a.png|1");
  CHECK(test::has(refusal("# image x y\na.png 1\n", images), "has no column image"));
}

TEST_CASE("columns are found by any of their names, with a unit") {
  const RowRules rules = {
      .columns = {"time", "x", "heading", "lon"}, .needed = 1, .has_others = true};
  for (const char* name :
       {"time [ms]", "Time_MS", "TIMESTAMP (ms)", "time[ms]", "stamp ms", "milliseconds"}) {
    test::write_text("rows.csv",
                     fmt::format("other,{},heading [rad],X (mm),Lng\na,7,1,3,4\n", name));
    Rows rows("rows.csv", "rows.csv", rules);
    REQUIRE(rows.next());
    CHECK(rows.time_unit("time") == TimeUnit::milliseconds);
    CHECK(rows.text("time") == "7");
    CHECK(rows.real("x") == 0.003);
    CHECK(rows.real("heading") == Approx(180 / std::numbers::pi));
    CHECK(rows.real("lon") == 4);
    CHECK_FALSE(rows.has("lat"));
    CHECK_FALSE(rows.number("other"));
    CHECK_FALSE(rows.next());
    CHECK(rows.next());  // again
  }
  for (const char* name : {"times", "time m", "ms", "overtime_ms", "time_", "x_ms", ""})
    CHECK(test::has(refusal(fmt::format("{},x\n", name), rules), "has no column time"));
}

TEST_CASE("a list may have a header, or columns by position") {
  const auto scores = [](const std::string& text) {
    test::write_text("rows.csv", text);
    Rows rows("rows.csv", "rows.csv", kList);
    std::string found;
    while (rows.next())
      found += fmt::format("{}-{}:{} ", rows.frame("query"), rows.frame("match"),
                           rows.has("score") ? rows.real("score") : -1);
    return found;
  };
  CHECK(scores("5 1\n6 2\n") == "5-1:-1 6-2:-1 ");
  CHECK(scores("5;1;0.5\n") == "5-1:0.5 ");
  CHECK(scores("Score,Match,Query\n0.5,1,5\n") == "5-1:0.5 ");
  CHECK(scores("# nothing\n").empty());
  RowRules times = {{"time"}, 1, false, kListSeparators, true, true};
  CHECK(cells_of("time [ms]\n1 a\n", times) == "2 1|a");
  CHECK(cells_of("x [m] time ms y\n7 1500 1\n", times) == "2 7|1500|1");
  CHECK(test::has(refusal("seconds,nanoseconds\n0,5\n", times), "two columns time"));
}

TEST_CASE("integers are frames, however programs write them") {
  CHECK(parse_frame("7.000000000000000000e+00")->value == 7);
  CHECK(parse_frame("1.230000000000000000e+02")->value == 123);
  CHECK_FALSE(parse_frame("-1.000000000000000000e+00")->in_range);
  for (const char* name : {"1.5e+00", "2e3", "1.e", "img.e5", "1.0e300"})
    CHECK_FALSE(parse_frame(name));
}

TEST_CASE("missing, repeated and unknown columns are refused") {
  const RowRules pairs = {{"query", "reference", "label"}, 2};
  CHECK(refusal("query,label\n1,same\n", pairs) ==
        "rows.csv: has no column reference. Expected query,reference[,label]");
  CHECK(test::has(refusal("", pairs), "has no column query"));
  CHECK(test::has(refusal("query,Query,reference\n", pairs),
                  "two columns query: \"query\" and \"Query\". Remove or rename one"));
  CHECK(test::has(refusal("query,reference,weight\n", pairs),
                  "unknown column \"weight\". Known columns are query, reference, label"));
  CHECK(test::has(refusal("query,reference\n1\n", pairs), "line 2: expected 2 columns, found 1"));
  CHECK(test::has(refusal("1 2 3 4\n", kList), "line 1: expected 3 columns, found 4"));
  CHECK(test::has(refusal("1\n", kList), "has no column match. Expected query,match[,score]"));
  test::write_text("rows.csv", "5,one,07\n");
  Rows rows("rows.csv", "rows.csv", kList);
  REQUIRE(rows.next());
  CHECK(test::error_text([&] { rows.real("match"); }) ==
        "rows.csv, line 1: match \"one\" is not a number");
  CHECK(test::has(test::error_text([&] { rows.frame("score"); }),
                  "score \"07\" is not a frame number because of its leading zeros"));
  CHECK(test::has(test::error_text([&] { rows.frame("query", 4); }), "query \"5\" is not"));
  test::write_text("rows.csv", "query;match\n1;0,5\n");
  Rows german("rows.csv", "rows.csv", {{"query", "match"}, 2});
  REQUIRE(german.next());
  CHECK(test::has(test::error_text([&] { german.real("match"); }), "Write decimal points"));
}

TEST_CASE("the numbers that pandas writes as names of columns are refused") {
  CHECK(test::has(refusal("0,1,2\n5,3,0.5\n", kList), "pandas"));
  CHECK(cells_of("0,1,2\n1,3,5\n", kList) == "1 0|1|2 / 2 1|3|5");
  CHECK(test::has(refusal("0 1 2\n1 3 0.5\n", kList), "pandas"));
  CHECK(test::has(refusal(",0,1,2\n0,1,3,5\n", kList), "pandas"));
}
