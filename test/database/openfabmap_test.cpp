#include "database/openfabmap.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/error.h"
#include "base/random.h"
#include "support.h"

using namespace vpr;

namespace {

std::string yaml(const std::string& name, int rows, int cols, const std::string& type,
                 const std::string& data) {
  return fmt::format(
      "%YAML:1.0\n---\n{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: {}\n"
      "   data: [ {} ]\n",
      name, rows, cols, type, data);
}

const std::string kTree =
    yaml("ChowLiuTree", 4, 2, "d", "0., 0., 0.5, 0.25, 0.5, 0.75, 0.5, 0.125");

}  // namespace

TEST_CASE("OpenFABMAP's tree, vocabulary and frames are read") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "t.yml", kTree);
  const ChowLiuTree tree = read_openfabmap_tree(folder / "t.yml");
  CHECK(tree.parent == std::vector<uint32_t>{0, 0});
  CHECK(tree.p_given_not == std::vector<double>{0.5, 0.125});
  test::write_text(folder / "v.yml", yaml("Vocabulary", 2, 3, "f", "1., 2., 3., 4., 5., 6."));
  CHECK(read_openfabmap_vocabulary(folder / "v.yml").at<float>(1, 0) == 4);
  test::write_text(folder / "b.yml", yaml("BOWImageDescs", 3, 2, "f", "0., 0.25, 0., 0., 1., 2."));
  CHECK(read_openfabmap_frames({folder / "b.yml", {}}, 2) == std::vector<WordSet>{{1}, {}, {0, 1}});
  CHECK(read_openfabmap_frames({folder / "b.yml", {1, 3, 1}}, 2) ==
        std::vector<WordSet>{{}, {0, 1}});
  CHECK(test::error_kind([&] {
          read_openfabmap_frames({folder / "b.yml", {}}, 3);
        }) == ErrorKind::data);
  CHECK(test::error_kind([&] {
          read_openfabmap_frames({folder / "b.yml", {0, 4, 1}}, 2);
        }) == ErrorKind::usage);
}

TEST_CASE("trees that can't be meant are refused") {
  const std::string text =
      GENERATE(std::string(), std::string("nonsense"), yaml("Tree", 4, 1, "d", "0., 0.5, 0.5, 0.5"),
               yaml("ChowLiuTree", 4, 1, "f", "0., 0.5, 0.5, 0.5"),
               yaml("ChowLiuTree", 3, 1, "d", "0., 0.5, 0.5"),
               yaml("ChowLiuTree", 4, 1, "d", "1., 0.5, 0.5, 0.5"),
               yaml("ChowLiuTree", 4, 1, "d", "-1., 0.5, 0.5, 0.5"),
               yaml("ChowLiuTree", 4, 1, "d", ".Nan, 0.5, 0.5, 0.5"),
               yaml("ChowLiuTree", 4, 1, "d", "0., 0., 0.5, 0.5"),
               yaml("ChowLiuTree", 4, 1, "d", "0., 0.5, 1., 0.5"),
               yaml("ChowLiuTree", 4, 1, "d", "0., 1e-305, 0.5, 0.5"),
               yaml("ChowLiuTree", 4, 2, "d", "1., 0., 0.5, 0.5, 0.5, 0.5, 0.5, 0.5"));
  const test::TemporaryFolder folder;
  test::write_text(folder / "t.yml", text);
  CHECK(test::error_kind([&] { read_openfabmap_tree(folder / "t.yml"); }) == ErrorKind::data);
  CHECK(test::error_kind([&] { read_openfabmap_tree(folder / "none.yml"); }) == ErrorKind::input);
}

TEST_CASE("random damage gives an error or a tree, never a crash") {
  const test::TemporaryFolder folder;
  RandomEngine engine(1);
  for (int i = 0; i < 400; ++i) {
    std::string text = kTree.substr(0, 1 + uniform_below(engine, kTree.size()));
    text[uniform_below(engine, text.size())] = static_cast<char>(32 + uniform_below(engine, 95));
    test::write_text(folder / "t.yml", text);
    test::error_kind([&] { read_openfabmap_tree(folder / "t.yml"); });
  }
}
