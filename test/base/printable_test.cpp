#include <catch2/catch.hpp>

#include "base/text.h"

using namespace vpr;

TEST_CASE("text without control characters is shown as it is") {
  for (const char* text :
       {"", "walk 3", "a\\x1b", "\u00e4 \u20ac \U0001f642", "\xc2\xa0-\xc2\xb5"}) {
    CHECK(printable(text) == text);
    CHECK(printable_line(text) == text);
  }
}

TEST_CASE("control characters are shown, and not obeyed") {
  CHECK(printable("\x1b[2J \x1b]0;t\a") == "\\x1b[2J \\x1b]0;t\\x07");
  CHECK(printable("-\r\t-\x7f-") == "-\\x0d\\x09-\\x7f-");
  CHECK(printable(std::string("-\0-", 3)) == "-\\x00-");
  CHECK(printable("\xc2\x9b[2J") ==
        "\\xc2\\x9b[2J");  // an escape sequence's start in one character
  CHECK(printable("\xc2\x80\xc2\x9f\xc2\xa0") == "\\xc2\\x80\\xc2\\x9f\xc2\xa0");
}

TEST_CASE("bytes that are no UTF-8 are shown as numbers") {
  CHECK(printable("-\x9b[2J") == "-\\x9b[2J");
  CHECK(printable("\xc0\x9b") == "\\xc0\\x9b");  // an escape in two bytes
  CHECK(printable("\xe4") == "\\xe4");
}

TEST_CASE("a line feed ends a line, but never within a name") {
  CHECK(printable("-\n-") == "-\n-");
  CHECK(printable_line("-\n-") == "-\\x0a-");
}
