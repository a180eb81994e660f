#include "database/openfabmap.h"

#include <array>
#include <memory>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <zlib.h>

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

TEST_CASE("values nested deeper than a matrix are refused before they are parsed") {
  const test::TemporaryFolder folder;
  const auto repeated = [](const std::string& text) {
    std::string all;
    for (int i = 0; i < 200'000; ++i) all += text;
    return all;
  };
  const std::string yaml_start = "%YAML:1.0\n---\nChowLiuTree: ";
  const std::vector<std::pair<std::string, std::string>> files = {
      {"t.yml", yaml_start + repeated("[")},
      {"t.yml", yaml_start + repeated("{a: ")},
      {"t.yml", yaml_start + "\n" + repeated("-")},
      {"t.yml", yaml_start + "2\n.0\n-"},
      {"t.yml", yaml_start + "\n" + repeated("- ")},
      {"t.yml", yaml_start + "\"" + repeated("]\", [ \"") + "\""},
      {"t.json", "{\"ChowLiuTree\": " + repeated("[")},
      {"t.json", repeated("{\"a\": ")},
      {"t.xml", "<?xml version=\"1.0\"?>\n<opencv_storage>\n" + repeated("<a>\n")}};
  for (const auto& [name, text] : files) {
    test::write_text(folder / name, text);
    const auto read = [&] { read_openfabmap_tree(folder / name); };
    CHECK(test::error_kind(read) == ErrorKind::data);
    CHECK(test::error_text(read).find("nested") != std::string::npos);
  }
}

TEST_CASE("OpenCV's parser takes as many nested values as are let through") {
  const test::TemporaryFolder folder;
  const std::string yaml_start = "%YAML:1.0\n---\nChowLiuTree: \n ";
  const std::vector<std::array<std::string, 3>> files = {
      {"t.yml", yaml_start, "["},
      {"t.json", "{\"ChowLiuTree\": ", "["},
      {"t.xml", "<?xml version=\"1.0\"?>\n<opencv_storage>\n", "<a>\n"}};
  for (const auto& [name, start, level] : files) {
    std::string text = start;
    for (int i = 0; i < 24; ++i) text += level;
    test::write_text(folder / name, text);
    const auto read = [&] { read_openfabmap_tree(folder / name); };
    CHECK(test::error_kind(read) == ErrorKind::data);
    CHECK(test::error_text(read).find("nested") == std::string::npos);
  }
}

TEST_CASE("a matrix that claims more values than it has is refused before there is room for them") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "v.yml", yaml("Vocabulary", 2000000000, 2000000000, "f", "1., 2."));
  const auto read = [&] { read_openfabmap_vocabulary(folder / "v.yml"); };
  CHECK(test::error_kind(read) == ErrorKind::data);
  test::write_text(folder / "v.yml", yaml("Vocabulary", 1, 2, "f", "1., 2."));
  CHECK(read_openfabmap_vocabulary(folder / "v.yml").cols == 2);
}

TEST_CASE("a zero byte is refused before it is parsed") {
  const test::TemporaryFolder folder;
  const std::string zeros(2, '\0');
  test::write_text(folder / "t.xml", "<?xml version=\"1.0\"?>\n<opt" + zeros + "rage>\n");
  const auto read = [&] { read_openfabmap_tree(folder / "t.xml"); };
  CHECK(test::error_kind(read) == ErrorKind::data);
  CHECK(test::error_text(read).find("no such text") != std::string::npos);
}

TEST_CASE("numbers of any sign and exponent are no nested values") {
  const test::TemporaryFolder folder;
  std::string values = "-.5, 1e-05";
  for (int i = 2; i < 3000; ++i) values += ", -1.5e-05";
  test::write_text(folder / "v.yml", yaml("Vocabulary", 1, 3000, "f", values));
  CHECK(read_openfabmap_vocabulary(folder / "v.yml").at<float>(0, 0) == -.5F);
}

TEST_CASE("a compressed file is read, and one that unpacks to too much is refused") {
  const test::TemporaryFolder folder;
  const std::string path = folder / "t.yml.gz";
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(::gzopen(path.c_str(), "wb1"), ::gzclose);
  REQUIRE(file);
  ::gzwrite(file.get(), kTree.data(), static_cast<unsigned>(kTree.size()));
  ::gzflush(file.get(), Z_FINISH);
  CHECK(read_openfabmap_tree(path).parent == std::vector<uint32_t>{0, 0});
  const std::string spaces(1 << 20, ' ');
  for (int i = 0; i < 128; ++i)
    ::gzwrite(file.get(), spaces.data(), static_cast<unsigned>(spaces.size()));
  ::gzflush(file.get(), Z_FINISH);
  CHECK(test::error_text([&] { read_openfabmap_tree(path); }).find("gunzip") != std::string::npos);
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
