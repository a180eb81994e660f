#include "base/output_file.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "support.h"

using namespace vpr;

namespace {

bool has_marker(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "marker");
}

void write_file(const std::filesystem::path& path, const std::string& text, Existing existing) {
  OutputFile file(path, existing);
  file.write(text);
  file.commit();
}

}  // namespace

TEST_CASE("a file appears only when it is committed") {
  const test::TemporaryFolder folder;
  {
    OutputFile file(folder / "a", Existing::refuse);
    file.write("half");
    CHECK_FALSE(std::filesystem::exists(folder / "a"));
  }
  CHECK(test::list_folder(folder.path()).empty());
  write_file(folder / "a", "whole", Existing::refuse);
  CHECK(test::read_text(folder / "a") == "whole");
  CHECK(test::list_folder(folder.path()) == std::vector<std::string>{"a"});
}

TEST_CASE("an existing file is refused, before the work and at its end") {
  const test::TemporaryFolder folder;
  OutputFile late(folder / "a", Existing::refuse);
  test::write_text(folder / "a", "first");  // somebody else was faster
  CHECK(test::error_kind([&] { late.commit(); }) == ErrorKind::usage);
  CHECK(test::error_kind([&] { write_file(folder / "a", "x", Existing::refuse); }) ==
        ErrorKind::usage);
  CHECK(test::read_text(folder / "a") == "first");
  write_file(folder / "a", "second", Existing::replace);
  CHECK(test::read_text(folder / "a") == "second");
}

TEST_CASE("a missing parent folder and a folder in the way are errors") {
  const test::TemporaryFolder folder;
  CHECK(test::error_kind([&] { check_output_file(folder / "no/a", Existing::refuse); }) ==
        ErrorKind::output);
  CHECK(test::error_kind([&] { check_output_file(folder.path(), Existing::replace); }) ==
        ErrorKind::usage);
}

TEST_CASE("a folder is replaced in one step, and only one of ours") {
  const test::TemporaryFolder folder;
  const auto write = [&](const std::string& text, Existing existing) {
    OutputFolder output(folder / "db", existing, has_marker);
    write_file(output.temporary() / "marker", text, Existing::refuse);
    output.commit();
  };
  write("one", Existing::refuse);
  CHECK(test::error_kind([&] { write("two", Existing::refuse); }) == ErrorKind::usage);
  write("two", Existing::replace);
  CHECK(test::read_text(folder / "db/marker") == "two");
  CHECK(test::list_folder(folder.path()) == std::vector<std::string>{"db"});
  std::filesystem::create_directory(folder / "home");
  test::write_text(folder / "home/letter", "dear");
  CHECK(test::error_kind([&] { OutputFolder(folder / "home", Existing::replace, has_marker); }) ==
        ErrorKind::usage);
  CHECK(test::read_text(folder / "home/letter") == "dear");
}

TEST_CASE("a full disk is an output error") {
  if (!std::filesystem::exists("/dev/full")) return;
  OutputFile file(std::filesystem::temp_directory_path() / "vpr-full-test", Existing::replace);
  CHECK(test::error_kind([&] { file.reserve(uint64_t{1} << 60); }) == ErrorKind::output);
}

TEST_CASE("a part of a folder that can't be made is an output error") {
  const test::TemporaryFolder folder;
  make_part_folder(folder / "sub");
  CHECK(test::error_kind([&] { make_part_folder(folder / "sub"); }) == ErrorKind::output);
  CHECK(test::error_kind([&] { make_part_folder(folder / "no/sub"); }) == ErrorKind::output);
}

TEST_CASE("what is no regular file is not replaced") {
  const test::TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/null", folder / "null");
  CHECK(test::error_kind([&] { write_file(folder / "null", "x", Existing::replace); }) ==
        ErrorKind::usage);
}
