#include "base/zip_file.h"

#include <cstring>

#include <catch2/catch.hpp>

#include "npz.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

void write_archive(const std::filesystem::path& path,
                   const std::vector<std::pair<std::string, std::string>>& files) {
  Outputs outputs(Existing::replace);
  ZipWriter archive(outputs.file(path));
  for (const auto& [name, text] : files)
    archive.add(
        name, {bytes_of(text).first(text.size() / 2), bytes_of(text).subspan(text.size() / 2), {}});
  archive.finish();
  outputs.commit();
}

}  // namespace

TEST_CASE("files of an archive are read back, and begin at multiples of 64 bytes") {
  std::vector<std::pair<std::string, std::string>> files = {{"empty.npy", ""}};
  for (size_t size = 1; size < 200; size += 13)
    files.emplace_back(std::string(size, 'n') + ".npy", std::string(size, static_cast<char>(size)));
  write_archive("a.npz", files);
  const std::string whole = read_text("a.npz");
  ZipFile archive("a.npz");
  REQUIRE(archive.names().size() == files.size());
  for (size_t i = 0; i < files.size(); ++i) {
    const auto& [name, text] = files[i];
    CHECK(archive.names()[i] == name);
    CHECK(npz_bytes("a.npz", name.substr(0, name.size() - 4)) == text);
    size_t at = 0;
    while (at < whole.size() && whole.compare(at, text.size(), text) != 0) at += 64;
    CHECK(at < whole.size());
  }
}

TEST_CASE("an archive without files is valid") {
  write_archive("a.npz", {});
  CHECK(ZipFile("a.npz").names().empty());
}

TEST_CASE("a damaged file of an archive is detected by its checksum") {
  write_archive("a.npz", {{"a.npy", "content"}});
  std::string whole = read_text("a.npz");
  CHECK(whole.substr(10, 8) == std::string("\0\0\x21\0\xa9\x30\xc5\xfe", 8));  // no time; CRC-32
  whole[whole.find("content")] = 'C';
  write_text("a.npz", whole);
  CHECK(error_kind([] { npz_bytes("a.npz", "a"); }) == ErrorKind::data);
}
