#include "base/npy.h"

#include <catch2/catch.hpp>

#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

std::filesystem::path write_example() {
  write_array<int32_t>("a.npy", {1, -2, 3, 4, 5, 6}, {2, 3});
  return "a.npy";
}

}  // namespace

TEST_CASE("an npy header equals NumPy's, padded to 64 bytes") {
  const std::string header = npy_header("<i4", {2, 3});
  CHECK(header.size() % 64 == 0);
  CHECK(header.substr(0, 10) == std::string("\x93NUMPY\x01\x00\x76\x00", 10));
  CHECK(header.substr(10, 57) == "{'descr': '<i4', 'fortran_order': False, 'shape': (2, 3),");
  CHECK(header.back() == '\n');
  CHECK(has(npy_header("|u1", {7}), "'shape': (7,), }"));
}

TEST_CASE("an array can be read back after writing") {
  const NpyArray array(write_example());
  CHECK(array.shape() == std::vector<size_t>{2, 3});
  const auto values = array.values<int32_t>(2);
  CHECK(std::vector<int32_t>(values.begin(), values.end()) ==
        std::vector<int32_t>{1, -2, 3, 4, 5, 6});
  CHECK(error_kind([&] { array.values<float>(2); }) == ErrorKind::data);
  CHECK(error_kind([&] { array.values<int32_t>(1); }) == ErrorKind::data);
}

TEST_CASE("an empty array can be read back") {
  write_array<int32_t>("e.npy", {}, {0, 4});
  CHECK(NpyArray("e.npy").values<int32_t>(2).empty());
}

TEST_CASE("every truncation of an array is refused") {
  const std::string whole = read_text(write_example());
  for (size_t size = 0; size < whole.size(); ++size) {
    write_text("cut.npy", whole.substr(0, size));
    REQUIRE(error_kind([&] { NpyArray("cut.npy"); }) == ErrorKind::data);
  }
  write_text("cut.npy", whole + "x");
  CHECK(error_kind([&] { NpyArray("cut.npy"); }) == ErrorKind::data);
}

TEST_CASE("invalid headers are refused") {
  const TemporaryFolder folder;
  const std::string shape =
      GENERATE("(9999999999999999999, 3)", "(4611686018427387904, 4)", "(-1, 3)", "(2, 3", "(a,)",
               "(18446744073709551615, 18446744073709551615)");
  std::string text = "{'descr': '<i4', 'fortran_order': False, 'shape': " + shape + ", }";
  text.resize(118, ' ');
  write_text(folder / "l.npy",
             std::string("\x93NUMPY\x01\x00\x76\x00", 10) + text + std::string(24, 'x'));
  CHECK(error_kind([&] { NpyArray(folder / "l.npy"); }) == ErrorKind::data);
}

TEST_CASE("a missing array is an input error") {
  CHECK(error_kind([] { NpyArray("/nonexistent/a.npy"); }) == ErrorKind::input);
}
