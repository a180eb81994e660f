#include "base/checksum.h"

#include <catch2/catch.hpp>

using namespace vpr;

TEST_CASE("checksums are XXH3's 128-bit values") {
  CHECK(checksum("") == "xxh3:99aa06d3014798d86001c324468d497f");  // published test vector
  CHECK(checksum("a") != checksum("b"));
}

TEST_CASE("a stream gives the checksum of the whole however it is cut") {
  const std::string text(1000, 'x');
  ChecksumStream stream;
  stream.add(std::as_bytes(std::span(text).first(1)));
  stream.add(std::as_bytes(std::span(text).subspan(1, 700)));
  stream.add({});
  stream.add(std::as_bytes(std::span(text).subspan(701)));
  CHECK(stream.text() == checksum(text));
}
