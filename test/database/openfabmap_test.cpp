#include "database/openfabmap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <zlib.h>

#include "base/error.h"
#include "base/random.h"
#include "database/opencv_yaml.h"
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

TEST_CASE("values nested deeper than a matrix are refused, however deep") {
  const test::TemporaryFolder folder;
  const auto repeated = [](const std::string& text) {
    std::string all;
    for (int i = 0; i < 200'000; ++i) all += text;
    return all;
  };
  const std::string level = GENERATE(std::string("["), std::string("{a: "), std::string("\n- - "),
                                     std::string("[ 1, "), std::string("? "));
  for (const std::string name : {"ChowLiuTree", "Other"}) {
    test::write_text(folder / "t.yml",
                     fmt::format("%YAML:1.0\n---\n{}: {}", name, repeated(level)));
    const auto read = [&] { read_openfabmap_tree(folder / "t.yml"); };
    CHECK(test::error_kind(read) == ErrorKind::data);
  }
}

TEST_CASE("what OpenCV writes in another format is refused with what to do") {
  const test::TemporaryFolder folder;
  for (const std::string text :
       {"{\"ChowLiuTree\": [", "<?xml version=\"1.0\"?>\n<opencv_storage>\n<a>\n", "%YAM", ""}) {
    test::write_text(folder / "t.yml", text);
    const auto read = [&] { read_openfabmap_tree(folder / "t.yml"); };
    CHECK(test::error_kind(read) == ErrorKind::data);
    CHECK(test::error_text(read).find("cv::FileStorage") != std::string::npos);
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

TEST_CASE("matrices are read as OpenCV reads them") {
  const test::TemporaryFolder folder;
  RandomEngine engine(7);
  const int type = GENERATE(CV_32F, CV_64F);
  cv::Mat written(40, 33, CV_64F);
  for (double& value : cv::Mat_<double>(written))
    value = std::ldexp(static_cast<double>(uniform_below(engine, 1 << 30)) - (1 << 29),
                       static_cast<int>(uniform_below(engine, 100)) - 60);
  written.at<double>(0, 0) = std::numeric_limits<double>::infinity();
  written.at<double>(0, 1) = -std::numeric_limits<double>::infinity();
  written.at<double>(0, 2) = std::numeric_limits<double>::quiet_NaN();
  written.at<double>(0, 3) = 0;
  written.convertTo(written, type);
  const std::string path = folder / GENERATE("m.yml", "m.yml.gz");
  {
    cv::FileStorage file(path, cv::FileStorage::WRITE);
    file << "Settings"
         << "{"
         << "list"
         << "[" << 1 << 2 << "]"
         << "name"
         << "a: b"
         << "}";
    file << "Other" << cv::Mat(2, 2, type, cv::Scalar(1)) << "Matrix" << written;
  }
  cv::Mat expected;
  cv::FileStorage(path, cv::FileStorage::READ)["Matrix"] >> expected;
  const cv::Mat read = read_opencv_matrix(path, "Matrix", type);
  REQUIRE(read.size() == expected.size());
  REQUIRE(read.type() == expected.type());
  cv::Mat_<double> values;
  cv::Mat_<double> expected_values;
  read.convertTo(values, CV_64F);
  expected.convertTo(expected_values, CV_64F);
  CHECK(std::equal(values.begin(), values.end(), expected_values.begin(), [](double a, double b) {
    return a == b || (std::isnan(a) && std::isnan(b));  // there are many NaNs
  }));
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
