// The main of every test program: exit code 77 tells CTest that a test lacked its data.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include "support.h"

int main(int argc, char** argv) {
  const int failed = Catch::Session().run(argc, argv);
  if (failed != 0) return failed;
  return vpr::test::lacked_data() ? 77 : 0;
}
