#include "base/csv.h"

#include <catch2/catch.hpp>

#include "support.h"

using namespace vpr;
using namespace vpr::test;

TEST_CASE("fields may be quoted, rows may end in CR LF, empty lines are skipped") {
  const auto rows = parse_csv(
      "\xef\xbb\xbf"
      "a,b\r\n\r\n\"x,\"\"y\"\"\",2\n\n3,",
      "t");
  REQUIRE(rows.size() == 3);
  CHECK(rows[0].fields == std::vector<std::string>{"a", "b"});
  CHECK(rows[1].fields == std::vector<std::string>{"x,\"y\"", "2"});
  CHECK(rows[1].line == 3);
  CHECK(rows[2].fields == std::vector<std::string>{"3", ""});
  CHECK(rows[2].line == 5);
  CHECK(parse_csv("", "t").empty());
}

TEST_CASE("an unterminated quote, or one inside a field, is an error") {
  const std::string text = GENERATE("a,\"b", "a\"b,c", "\"a\"b");
  CHECK(error_kind([&] { parse_csv(text, "t"); }) == ErrorKind::data);
}

TEST_CASE("a CSV field can be read back after writing") {
  for (const std::string text : {"plain", "a,b", "say \"hi\"", "two\nlines", ""})
    CHECK(parse_csv("x," + csv_field(text), "t")[0].fields[1] == text);
}
