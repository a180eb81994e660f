#include <cmath>

#include <catch2/catch.hpp>

#include "fabmap/word_training.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

TEST_CASE("OpenFABMAP's tree, vocabulary and frames are read") {
  write_array<double>("t.npy", {0, 0, 0.5, 0.25, 0.5, 0.75, 0.5, 0.125}, {4, 2});
  const ChowLiuTree tree = read_openfabmap_tree("t.npy");
  CHECK(tree.parent == std::vector<uint32_t>{0, 0});
  CHECK(tree.p_given_not == std::vector<double>{0.5, 0.125});
  write_array<float>("v.npy", {1, 2, 3, 4, 5, 6}, {2, 3});
  CHECK(read_openfabmap_vocabulary("v.npy").at<float>(1, 0) == 4);
  write_array<float>("b.npy", {0, 0.25, 0, 0, 1, 2}, {3, 2});
  const std::vector<WordSet> all = {{1}, {}, {0, 1}};
  CHECK(read_openfabmap_frames({"b.npy", {}}, 2) == all);
  write_array<uint8_t>("u.npy", {0, 1, 0, 0, 1, 1}, {3, 2});
  CHECK(read_openfabmap_frames({"u.npy", {}}, 2) == all);
  CHECK(read_openfabmap_frames({"b.npy", {1, 3, 1}}, 2) == std::vector<WordSet>{{}, {0, 1}});
  CHECK(error_kind([&] { read_openfabmap_frames({"b.npy", {}}, 3); }) == ErrorKind::data);
  CHECK(error_kind([&] { read_openfabmap_frames({"b.npy", {0, 4, 1}}, 2); }) == ErrorKind::usage);
}

TEST_CASE("invalid trees are refused") {
  const auto refused = [&](const std::vector<double>& values, size_t rows) {
    write_array<double>("t.npy", values, {rows, values.size() / rows});
    CHECK(error_kind([&] { read_openfabmap_tree("t.npy"); }) == ErrorKind::data);
  };
  refused({0, 0.5, 0.5}, 3);
  refused({1, 0.5, 0.5, 0.5}, 4);
  refused({-1, 0.5, 0.5, 0.5}, 4);
  refused({NAN, 0.5, 0.5, 0.5}, 4);
  refused({0, 0, 0.5, 0.5}, 4);
  refused({0, 0.5, 1, 0.5}, 4);
  refused({0, 1e-305, 0.5, 0.5}, 4);
  refused({1, 0, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5}, 4);
  write_array<float>("t.npy", {0, 0.5F, 0.5F, 0.5F}, {4, 1});
  CHECK(error_kind([&] { read_openfabmap_tree("t.npy"); }) == ErrorKind::data);
  CHECK(error_kind([&] { read_openfabmap_tree("none.npy"); }) == ErrorKind::input);
}

TEST_CASE("vocabularies without finite words are refused") {
  const auto read = [&] { read_openfabmap_vocabulary("v.npy"); };
  write_array<float>("v.npy", {1, INFINITY}, {1, 2});
  CHECK(error_kind(read) == ErrorKind::data);
  write_array<float>("v.npy", {}, {size_t{1} << 31, 0});
  CHECK(error_kind(read) == ErrorKind::data);
}

TEST_CASE("OpenFABMAP's YAML is refused, and its converter is suggested") {
  write_text("tree.yml", "%YAML:1.0\n---\n");
  write_text("tree.yml.gz", "\x1f\x8b");
  for (const char* name : {"tree.yml", "tree.yml.gz"})
    CHECK(has(error_text([&] { read_openfabmap_tree(name); }), "scripts/convert/openfabmap.py"));
}
