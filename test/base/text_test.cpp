// Text: parts, words, plurals, control characters and tables of names.
#include "base/text.h"

#include <catch2/catch.hpp>

#include "base/named_table.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;
using Parts = std::vector<std::string_view>;

namespace {

struct Row {
  std::string_view name;
  int value;
};
constexpr std::array<Row, 3> kRows = {{{"first", 1}, {"second", 2}, {"first", 3}}};

}  // namespace

TEST_CASE("split returns the parts between separators, including empty ones") {
  CHECK(split("a,b", ',') == Parts{"a", "b"});
  CHECK(split("", ',') == Parts{""});
  CHECK(split(",a,,", ',') == Parts{"", "a", "", ""});
  CHECK(split("a b", ',') == Parts{"a b"});
}

TEST_CASE("lines lose their ends, and the last end does not start another line") {
  CHECK(split_lines("").empty());
  CHECK(split_lines("\n") == Parts{""});
  CHECK(split_lines("a\nb") == Parts{"a", "b"});
  CHECK(split_lines("a\r\nb\r\n") == Parts{"a", "b"});
  CHECK(split_lines("\na\n\n") == Parts{"", "a", ""});
  CHECK(split_lines("a\rb\n") == Parts{"a\rb"});
}

TEST_CASE("rows are selected by name, and the nearest name is suggested for an unknown one") {
  CHECK(find_named(kRows, "row", "second").value == 2);
  CHECK(find_named(kRows, "row", "first").value == 1);
  CHECK(names_of(kRows) == std::vector<std::string>{"first", "second", "first"});
  CHECK(error_kind([] { find_named(kRows, "row", "secnod"); }) == ErrorKind::usage);
  CHECK(error_text([] { find_named(kRows, "row", "secnod"); }) ==
        "unknown row \"secnod\"; did you mean second? There are first, second, first");
}

TEST_CASE("a count of one has no plural") {
  CHECK(counted(0, "recognition") == "0 recognitions");
  CHECK(counted(1, "recognition") == "1 recognition");
  CHECK(counted(2, "incorrect recognition") == "2 incorrect recognitions");
  CHECK(counted(1, "query", "queries") == "1 query");
  CHECK(counted(3, "query", "queries") == "3 queries");
}

TEST_CASE("text without control characters does not change") {
  for (const char* text :
       {"", "walk 3", "a\\x1b", "\u00e4 \u20ac \U0001f642", "\xc2\xa0-\xc2\xb5"}) {
    CHECK(printable(text) == text);
    CHECK(printable_line(text) == text);
  }
}

TEST_CASE("control characters are escaped") {
  CHECK(printable("\x1b[2J \x1b]0;t\a") == "\\x1b[2J \\x1b]0;t\\x07");
  CHECK(printable("-\r\t-\x7f-") == "-\\x0d\\x09-\\x7f-");
  CHECK(printable(std::string("-\0-", 3)) == "-\\x00-");
  CHECK(printable("\xc2\x9b[2J") ==
        "\\xc2\\x9b[2J");  // the start of an escape sequence in one character
  CHECK(printable("\xc2\x80\xc2\x9f\xc2\xa0") == "\\xc2\\x80\\xc2\\x9f\xc2\xa0");
}

TEST_CASE("bytes that are not valid UTF-8 are escaped") {
  CHECK(printable("-\x9b[2J") == "-\\x9b[2J");
  CHECK(printable("\xc0\x9b") == "\\xc0\\x9b");  // an overlong encoding
  CHECK(printable("\xe4") == "\\xe4");
}

TEST_CASE("a line feed is kept in text and escaped in names") {
  CHECK(printable("-\n-") == "-\n-");
  CHECK(printable_line("-\n-") == "-\\x0a-");
}
