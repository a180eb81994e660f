#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "base/text.h"

using vpr::natural_less;

TEST_CASE("runs of digits compare by value, the rest by bytes") {
  std::vector<std::string> names = {"10.jpg", "2.jpg", "a10b2",   "a2b10",  "1.jpg",
                                    "B",      "a",     "010.jpg", "a10b10", "\xc3\xa4"};
  std::sort(names.begin(), names.end(), natural_less);
  CHECK(names == std::vector<std::string>{"1.jpg", "2.jpg", "10.jpg", "010.jpg", "B", "a", "a2b10",
                                          "a10b2", "a10b10", "\xc3\xa4"});
}

TEST_CASE("numbers of any length compare by value") {
  CHECK(natural_less("f99999999999999999999998", "f99999999999999999999999"));
  CHECK(natural_less("f9", "f100000000000000000000000000"));
  CHECK(natural_less("f00000000000000000000000000", "f1"));
}

TEST_CASE("the order is strict and total") {
  const std::vector<std::string> names = {"",   "0",  "00", "1",   "01",    "a",     "a0",  "a00",
                                          "a1", "0a", "1a", "01a", "a01b1", "a1b01", "a1b1"};
  for (const auto& a : names) {
    CHECK_FALSE(natural_less(a, a));
    for (const auto& b : names) {
      if (a != b) CHECK(natural_less(a, b) != natural_less(b, a));
      for (const auto& c : names)
        if (natural_less(a, b) && natural_less(b, c)) REQUIRE(natural_less(a, c));
    }
  }
}
