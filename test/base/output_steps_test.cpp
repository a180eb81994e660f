// The order in which outputs reach the disk, and the files that remain if any step fails. The
// functions below replace the system calls while a test requests it.
#include <algorithm>
#include <cerrno>
#include <cstdio>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/output.h"
#include "support.h"

namespace {

/// Records calls, and makes one of them fail.
struct Calls {
  bool is_on = false;
  int failing = -1;                   ///< index of the failing call, from 0; negative: none
  bool has_flagless_renames = false;  ///< renames without flags, as on many network file systems
  std::vector<std::string> names = {};

  bool fails(const std::string& name) {
    if (!is_on) return false;
    names.push_back(name);
    if (static_cast<int>(names.size()) - 1 != failing) return false;
    errno = EIO;
    return true;
  }
} calls;  // NOLINT

}  // namespace

extern "C" int fsync(int file) {
  struct stat found {};
  ::fstat(file, &found);
  if (calls.fails(S_ISDIR(found.st_mode) ? "flush folder" : "flush file")) return -1;
  return static_cast<int>(::syscall(SYS_fsync, file));
}

extern "C" int renameat2(int from_folder, const char* from, int to_folder, const char* to,
                         unsigned int flags) noexcept {
  if (calls.is_on && calls.has_flagless_renames) {
    errno = EINVAL;
    return -1;
  }
  if (calls.fails("rename")) return -1;
  return static_cast<int>(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}

extern "C" int rename(const char* from, const char* to) noexcept {
  if (calls.fails("rename")) return -1;
  return static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

using Names = std::vector<std::string>;

bool is_any(const std::filesystem::path&) { return true; }

// Writes two files and a folder over old ones, and a new file.
void write_outputs(const TemporaryFolder& folder, int failing, bool has_flagless_renames = false) {
  Outputs outputs(Existing::replace);
  outputs.file(folder / "main").write("new");
  outputs.file(folder / "companion").write("new");
  outputs.file(folder / "fresh").write("new");
  write_part(outputs.folder(folder / "db", is_any).temporary() / "note", "new");
  calls = {true, failing, has_flagless_renames};
  try {
    outputs.commit();
  } catch (const Error&) {
    calls.is_on = false;
    throw;
  }
  calls.is_on = false;
}

void write_old(const TemporaryFolder& folder) {
  std::filesystem::create_directory(folder / "db");
  for (const char* name : {"main", "companion", "db/note"}) write_text(folder / name, "old");
}

}  // namespace

TEST_CASE("everything is flushed before the first rename, and the folder after the last") {
  const TemporaryFolder folder;
  write_old(folder);
  write_outputs(folder, -1);
  const auto first = std::find(calls.names.begin(), calls.names.end(), "rename");
  CHECK(std::count(calls.names.begin(), first, "flush file") == 4);
  CHECK(std::count(calls.names.begin(), first, "flush folder") == 1);
  CHECK(calls.names.back() == "flush folder");
  CHECK(std::count(first, calls.names.end(), "rename") == 4);
  CHECK(list_folder(folder.path()) == Names{"companion", "db", "fresh", "main"});
}

TEST_CASE("if any step fails, each output is complete, and the error lists the new ones") {
  const bool has_flagless_renames = GENERATE(false, true);
  int failing = 0;
  for (bool has_failed = true; has_failed; ++failing) {
    INFO("step " << failing);
    const TemporaryFolder folder;
    write_old(folder);
    const std::string sentence =
        error_text([&] { write_outputs(folder, failing, has_flagless_renames); });
    has_failed = !sentence.empty();
    bool is_any_old = false;
    for (const std::string name : {"main", "companion", "db"}) {
      const fs::path path = folder / (name == "db" ? "db/note" : name);
      const bool is_new = read_text(path) == "new";
      const bool is_said = has(sentence, (folder / name).string() + " is new");
      CHECK(is_new == (!has_failed || is_said));
      is_any_old = is_any_old || !is_new;
      if (name == "main" && is_new) CHECK_FALSE(is_any_old);
    }
    for (const std::string& name : list_folder(folder.path())) CHECK_FALSE(name.starts_with("."));
  }
  CHECK(failing > 9);
}
