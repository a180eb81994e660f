#include "base/text.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/named_table.h"
#include "support.h"

using namespace vpr;

namespace {

using Parts = std::vector<std::string_view>;

struct Row {
  std::string_view name;
  int value;
};
constexpr std::array<Row, 3> kRows = {{{"first", 1}, {"second", 2}, {"first", 3}}};

}  // namespace

TEST_CASE("parts are what stands between separators, empty ones included") {
  CHECK(split("a,b", ',') == Parts{"a", "b"});
  CHECK(split("", ',') == Parts{""});
  CHECK(split(",a,,", ',') == Parts{"", "a", "", ""});
  CHECK(split("a b", ',') == Parts{"a b"});
}

TEST_CASE("lines lose their ends, and the last end begins no line") {
  CHECK(split_lines("").empty());
  CHECK(split_lines("\n") == Parts{""});
  CHECK(split_lines("a\nb") == Parts{"a", "b"});
  CHECK(split_lines("a\r\nb\r\n") == Parts{"a", "b"});
  CHECK(split_lines("\na\n\n") == Parts{"", "a", ""});
  CHECK(split_lines("a\rb\n") == Parts{"a\rb"});
}

TEST_CASE("words stand between blanks, however many there are") {
  CHECK(split_words("").empty());
  CHECK(split_words(" \t ").empty());
  CHECK(split_words("1  2\t3 \r") == Parts{"1", "2", "3"});
}

TEST_CASE("rows are found by name, and the nearest is named where there is none") {
  CHECK(find_named(kRows, "row", "second").value == 2);
  CHECK(find_named(kRows, "row", "first").value == 1);
  CHECK(names_of(kRows) == std::vector<std::string>{"first", "second", "first"});
  CHECK(test::error_kind([] { find_named(kRows, "row", "secnod"); }) == ErrorKind::usage);
  CHECK(test::error_text([] { find_named(kRows, "row", "secnod"); }) ==
        "unknown row \"secnod\"; did you mean second? There are first, second, first");
}
