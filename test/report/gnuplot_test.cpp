#include "report/gnuplot.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "report/plot.h"
#include "support.h"

using namespace vpr;
namespace fs = std::filesystem;

TEST_CASE("what a folder is called is never read by gnuplot") {
  if (!can_draw_plots()) return;
  const test::TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());  // the bar must be a path's first character
  Plot plot;
  plot.file = "line";
  plot.lines.push_back({"a", {{0, 1}, {1, 2}}});
  for (const std::string name : {"|touch HERE;#", "two\nlines", "'quotes'"}) {
    fs::create_directory(name);
    draw_plot(plot, name);
    CHECK(test::list_folder(name) == std::vector<std::string>{"line.png", "line.svg"});
  }
  fs::current_path(before);
  CHECK_FALSE(fs::exists(folder / "HERE"));
}

TEST_CASE("a picture that ends early is not whole") {
  if (!can_draw_plots()) return;
  const test::TemporaryFolder folder;
  Plot plot;
  plot.file = "line";
  plot.lines.push_back({"a", {{0, 1}, {1, 2}}});
  draw_plot(plot, folder.path());
  for (const char* name : {"line.png", "line.svg"}) {
    CHECK(is_whole_picture(folder / name));
    const std::string whole = test::read_text(folder / name);
    for (const size_t bytes : {size_t{0}, whole.size() / 2, whole.size() - 8}) {
      test::write_text(folder / name, whole.substr(0, bytes));
      CHECK_FALSE(is_whole_picture(folder / name));
    }
  }
  CHECK_FALSE(is_whole_picture(folder / "none.png"));
}

TEST_CASE("a picture that can't be written is an error") {
  if (!can_draw_plots()) return;
  const test::TemporaryFolder folder;
  Plot plot;
  plot.file = "line";
  plot.lines.push_back({"a", {{0, 1}, {1, 2}}});
  fs::create_symlink("/dev/full", folder / "line.png");
  CHECK(test::error_kind([&] { draw_plot(plot, folder.path()); }) == ErrorKind::output);
  CHECK(test::error_kind([&] { draw_plot(plot, folder / "none"); }) == ErrorKind::output);
}
