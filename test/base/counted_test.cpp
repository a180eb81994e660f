#include <catch2/catch.hpp>

#include "base/text.h"

using namespace vpr;

TEST_CASE("a single thing has no plural") {
  CHECK(counted(0, "hit") == "0 hits");
  CHECK(counted(1, "hit") == "1 hit");
  CHECK(counted(2, "incorrect hit") == "2 incorrect hits");
  CHECK(counted(1, "query", "queries") == "1 query");
  CHECK(counted(3, "query", "queries") == "3 queries");
}
