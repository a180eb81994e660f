#include <fstream>
#include <future>

#include <catch2/catch.hpp>

#include "sequence/live_source.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

// Writes a file under another name and renames it, as other programs do.
void put(const fs::path& folder, const std::string& name) {
  write_image(folder / ".part.png", 1);
  fs::rename(folder / ".part.png", folder / name);
}

std::future<fs::path> next_of(GrowingFolder& folder) {
  return std::async(std::launch::async, [&] { return folder.next({}); });
}

}  // namespace

TEST_CASE("images arrive in natural order, as soon as they are renamed into a folder") {
  const TemporaryFolder folder;
  put(folder.path(), "10.png");
  put(folder.path(), "9.png");
  put(folder.path(), "notes.txt");
  put(folder.path(), ".hidden.png");
  GrowingFolder growing(folder.path(), 20ms);
  CHECK(growing.next({}) == folder / "9.png");  // it existed, and has not changed
  CHECK(growing.next({}) == folder / "10.png");
  put(folder.path(), "11.png");
  CHECK(growing.next({}) == folder / "11.png");  // renamed: returned at once
  for (int i = 12; i < 40; ++i) {
    auto next = next_of(growing);
    put(folder.path(), std::to_string(i) + ".png");
    CHECK(next.get() == folder / (std::to_string(i) + ".png"));
  }
}

TEST_CASE("an unfinished file is awaited") {
  const TemporaryFolder folder;
  GrowingFolder growing(folder.path(), 1h);
  write_image(folder / ".whole.png", 1);
  const std::string image = read_text(folder / ".whole.png");
  std::ofstream file(folder / "1.png", std::ios::binary);
  file << image.substr(0, 50) << std::flush;
  auto next = std::async(std::launch::async, [&] { return fs::file_size(growing.next({})); });
  file << image.substr(50) << std::flush;
  file.close();
  CHECK(next.get() == image.size());
}

TEST_CASE("an image whose writer pauses is awaited, and a warning names it once") {
  const TemporaryFolder folder;
  write_image(folder / ".whole.png", 1);
  const std::string image = read_text(folder / ".whole.png");
  const bool is_closed = GENERATE(false, true);  // between the parts
  GrowingFolder growing(folder.path(), 0ms);
  std::ofstream file(folder / "1.png", std::ios::binary);
  file << image.substr(0, 50) << std::flush;
  if (is_closed) file.close();
  std::promise<void> was_incomplete;
  int warnings = 0;
  Monitor monitor;
  monitor.warn = [&](const std::string& sentence) {
    CHECK(has(sentence, "1.png: is incomplete"));
    if (warnings++ == 0) was_incomplete.set_value();
  };
  auto next = std::async(std::launch::async, [&] { return fs::file_size(growing.next(monitor)); });
  was_incomplete.get_future().wait();
  if (is_closed) file.open(folder / "1.png", std::ios::binary | std::ios::app);
  file << image.substr(50) << std::flush;
  file.close();
  CHECK(next.get() == image.size());
  CHECK(warnings == 1);
}

TEST_CASE("later images wait for an incomplete one, for a bounded time") {
  const TemporaryFolder folder;
  GrowingFolder growing(folder.path(), 50ms);
  write_image(folder / ".whole.png", 1);
  const std::string image = read_text(folder / ".whole.png");
  std::ofstream file(folder / "1.png", std::ios::binary);
  file << image.substr(0, 50) << std::flush;
  put(folder.path(), "2.png");
  auto next = next_of(growing);
  CHECK(next.wait_for(150ms) == std::future_status::timeout);
  file << image.substr(50) << std::flush;
  file.close();
  CHECK(next.get() == folder / "1.png");
  CHECK(growing.next({}) == folder / "2.png");
  write_text(folder / "3.png", "x");  // never complete
  put(folder.path(), "4.png");
  CHECK(growing.next({}) == folder / "3.png");
  CHECK(growing.next({}) == folder / "4.png");
}

TEST_CASE("a broken image with a late name does not make earlier ones be used too soon") {
  const TemporaryFolder folder;
  write_text(folder / "9999.png", "x");
  GrowingFolder growing(folder.path(), 20ms);
  put(folder.path(), "1.png");
  CHECK(growing.next({}) == folder / "1.png");
  auto next = next_of(growing);
  CHECK(next.wait_for(300ms) == std::future_status::timeout);
  put(folder.path(), "2.png");
  CHECK(next.get() == folder / "2.png");
}

TEST_CASE("an existing file is returned when its size is stable") {
  const TemporaryFolder folder;
  write_image(folder / "1.png", 1);
  GrowingFolder growing(folder.path(), 0ms);
  CHECK(growing.next({}) == folder / "1.png");
}

TEST_CASE("an image that arrives too late is omitted with a warning") {
  const TemporaryFolder folder;
  GrowingFolder growing(folder.path(), 1h);
  put(folder.path(), "5.png");
  CHECK(growing.next({}) == folder / "5.png");
  put(folder.path(), "3.png");
  put(folder.path(), "6.png");
  Monitor monitor;
  std::string said;
  monitor.warn = [&](const std::string& sentence) { said += sentence; };
  CHECK(growing.next(monitor) == folder / "6.png");
  CHECK(has(said, "3.png: arrived after 5.png"));
}

TEST_CASE("waiting ends on a stop and when the folder is removed") {
  fs::create_directory("f");
  GrowingFolder growing("f", 1h);
  std::atomic<bool> stop = true;
  Monitor monitor;
  monitor.stop = &stop;
  CHECK(error_kind([&] { growing.next(monitor); }) == ErrorKind::interrupted);
  fs::remove("f");
  CHECK(error_kind([&] { growing.next({}); }) == ErrorKind::input);
  CHECK(error_kind([&] { GrowingFolder{"f"}; }) == ErrorKind::input);
}
