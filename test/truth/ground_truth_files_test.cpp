// Pairs, matrices and presets, first on tiny cases, then at their edges.
#include <catch2/catch.hpp>

#include "base/error.h"
#include "truth/formats.h"
#include "truth/truth_files.h"

using namespace vpr;
using test::draw;
using test::read_labels;
using test::write_matrix;
using test::write_text;
using test::write_truth;

TEST_CASE("pairs are joined to runs and detected by content") {
  write_text("g.txt", "query,reference,label\n0,2,\n0,1,\n0,1,\n1,0,ignore\n");
  CHECK(read_labels("g.txt", 2, 4) == ".SS. i...");
  const auto found =
      inspect_ground_truth({"", "g.txt"}, {{"", kUnknownFrames}, {{"", kUnknownFrames}}});
  CHECK(found.format == "pairs");
  CHECK(found.scope.query.frames == 2);
  CHECK(found.scope.sequences[0].sequence.frames == 3);
  CHECK(found.findings[size_t(FindingKind::duplicate)].count == 1);
}

TEST_CASE("pairs in memory have the labels of their file") {
  const auto labels = [](std::vector<PlacePair> pairs, int tolerance = 0) {
    GroundTruthArgument argument{"pairs", "pairs", tolerance};
    argument.pairs = std::make_shared<const std::vector<PlacePair>>(std::move(pairs));
    return read_labels(argument, 2, 4);
  };
  CHECK(labels({{0, 2}, {0, 1}, {0, 1}, {1, 0, "ref"}}) == ".SS. S...");
  CHECK(labels({{0, 2}}, 1) == ".SSS ....");
  CHECK(labels({}) == ".... ....");
  test::check_refused([&] { labels({{0, 0}, {2, 0}}); }, "pairs, pair 1: query 2 is out of range");
  test::check_refused([&] { labels({{0, 4}}); }, "pairs, pair 0: reference 4 is out of range");
  test::check_refused([&] { labels({{0, 0, "other"}}); }, "no training sequence \"other\"");
}

TEST_CASE("ranges of pairs are those of the query") {
  write_text("g.csv", "query,reference\n0,0\n1,1\n2,2\n3,3\n4,4\n");
  CHECK(read_labels("g.csv@1:4", 3, 5) == ".S... ..S.. ...S.");
  CHECK(read_labels("g.csv@1:5:2", 2, 5) == ".S... ...S.");
  CHECK(read_labels("g.csv@3:", 2, 5) == "...S. ....S");
  CHECK(test::has(test::error_text([&] { read_labels("g.csv@1:4", 2, 5); }),
                  "its range has 3 frames"));
  const std::string beyond = test::error_text([&] { read_labels("g.csv", 3, 5); });
  CHECK(test::has(beyond, "line 5: query 3 is out of range"));
  CHECK(test::has(beyond, "g.csv@60:111"));
  write_matrix<uint8_t>("m.npy", {0, 1, 0, 0}, 2, 2, "|b1");
  CHECK(test::error_kind([&] { read_labels("m.npy@1:2", 1, 2); }) == ErrorKind::usage);
  // The names of other query frames are outside it.
  write_text("g.csv", "query,reference\na.png,0\nb.png,1\nc.png,2\n");
  GroundTruthScope scope{{"q", 2}, {{{"t", 5}}}, [] {
                           return std::vector<std::string>{"x/b.png", "x/c.png"};
                         }};
  const auto named = [&](const std::string& path) {
    return read_ground_truth({"", path}, scope).pairs;
  };
  CHECK(named("g.csv@1:3") == decltype(GroundTruth::pairs){{{0, 1}}, {{0, 2}}});
  CHECK(test::has(test::error_text([&] { named("g.csv"); }), "g.csv@60:111"));
  CHECK(test::has(test::error_text([&] { parse_ground_truth_argument("aligned@1:3", 0); }),
                  "has no range"));
}

TEST_CASE("aligned sequences may have different sampling") {
  GroundTruthArgument argument{"aligned", {}, 1};
  argument.options.train_step = 2.5;  // 0, 2.5, 5 become 0, 3, 5
  CHECK(draw(read_ground_truth(argument, {{"", 3}, {{"ref", 7}}}), 3, 7) ==
        "SS..... ..SSS.. ....SSS");
  argument.options.train_step = 0;
  CHECK(test::error_kind([&] {
          read_ground_truth(argument, {{"", 3}, {{"ref", 7}}});
        }) == ErrorKind::usage);
}

TEST_CASE("presets are aligned within their tolerance, with the step of their data set") {
  const auto reach = [](const std::string& name, size_t query, size_t train) {
    const GroundTruth truth = read_ground_truth({name}, {{"", query}, {{"ref", train}}});
    return std::pair(draw(truth, query, train).substr(0, train), truth.protocol);
  };
  CHECK(reach("nordland-exact", 3, 12).first == "S...........");
  CHECK(reach("nordland-patch-netvlad", 3, 12).first == "SSS.........");
  CHECK(reach("nordland-25m", 3, 12).first == "SSSSSSSSSSS.");
  const GroundTruth tenth = read_ground_truth({"nordland-vpr-bench"}, {{"", 3}, {{"ref", 22}}});
  CHECK(draw(tenth, 3, 22) ==
        "SS.................... .........SSS.......... ...................SSS");
  const GroundTruth alike = read_ground_truth({"nordland-vpr-bench"}, {{"", 3}, {{"ref", 4}}});
  CHECK(draw(alike, 3, 4) == "SS.. SSS. .SSS");
  CHECK(test::has(tenth.protocol, "10 i"));
  CHECK(test::has(alike.protocol, "training frame i,"));
}

TEST_CASE("an unknown format, or an option without effect, is a usage error") {
  write_text("what.txt", "hello world\n");
  CHECK(test::error_kind([&] { read_labels("what.txt", 2, 2); }) == ErrorKind::usage);
  write_text("what.csv", "hello,world\n");
  CHECK(test::error_kind([&] { read_labels("what.csv", 2, 2); }) == ErrorKind::data);
  CHECK(test::error_kind([&] { read_labels("missing", 2, 2); }) == ErrorKind::input);
  CHECK(test::has(test::error_text([] { read_ground_truth({"pair", "x"}, {}); }), "pairs"));
  CHECK(test::error_kind([] { read_ground_truth({"pairs"}, {}); }) == ErrorKind::usage);
  write_text("g.csv", "query,reference\n");
  GroundTruthArgument argument{"", "g.csv"};
  argument.options.radius_m = 3;
  CHECK(test::has(test::error_text([&] { read_labels(argument, 2, 2); }), "--radius"));
}

TEST_CASE("an empty archive is damaged ground truth") {
  write_text("none.npz", std::string("PK\x05\x06") + std::string(18, '\0'));
  CHECK(test::error_kind([&] { read_labels("none.npz", 1, 1); }) == ErrorKind::data);
}

TEST_CASE("matrices may have any number type and a soft matrix") {
  write_matrix<uint8_t>("b.npy", {1, 0, 0, 0, 1, 0}, 2, 3, "|b1");
  write_matrix<double>("d.npy", {1, 0, 0, 0, 1, 0}, 2, 3, "<f8");
  write_matrix<int64_t>("i.npy", {1, 0, 0, 0, 1, 0}, 2, 3, "<i8");
  write_matrix<uint8_t>("soft.npy", {1, 1, 0, 0, 0, 1}, 2, 3, "|b1");
  for (const std::string name : {"b.npy", "d.npy", "i.npy"}) {
    CHECK(read_labels(name, 2, 3) == "S.. .S.");
    CHECK(read_labels(name, 3, 2) == "S. .S ..");  // only the transposed shape fits
  }
  GroundTruthArgument argument{"", "b.npy"};
  argument.options.soft = "soft.npy";
  CHECK(read_labels(argument, 2, 3) == "Si. .Si");
  argument.options.matrix_rows = MatrixRows::reference;
  CHECK(read_labels(argument, 3, 2) == "S. iS .i");
  CHECK(test::error_kind([&] { read_labels(argument, 2, 3); }) == ErrorKind::data);
  write_matrix<uint8_t>("soft.npy", {1, 1, 0, 0, 0, 1}, 3, 2, "|b1");
  CHECK(test::error_kind([&] { read_labels(argument, 3, 2); }) == ErrorKind::data);
}

TEST_CASE("rows of square matrices are queries unless the options or the file differ") {
  write_matrix<uint8_t>("s.npy", {0, 1, 0, 0}, 2, 2, "|u1");
  CHECK(read_labels("s.npy", 2, 2) == ".S ..");
  GroundTruthArgument argument{"", "s.npy"};
  argument.options.matrix_rows = MatrixRows::reference;
  CHECK(read_labels(argument, 2, 2) == ".. S.");
  // Fortran order: the same bytes are the transposed matrix.
  std::string header = npy_header("|u1", {2, 2});
  header.replace(header.find("False,"), 6, "True, ");
  write_text("f.npy", header + std::string("\0\1\0\0", 4));
  CHECK(read_labels("f.npy", 2, 2) == ".. S.");
}

TEST_CASE("invalid matrices are refused") {
  write_matrix<uint8_t>("v.npy", {0, 2, 0, 0}, 2, 2, "|u1");
  write_matrix<float>("nan.npy", {0, NAN, 0, 0}, 2, 2, "<f4");
  write_matrix<float>("half.npy", {0, 0.5f, 0, 0}, 2, 2, "<f4");
  write_matrix<uint8_t>("short.npy", {0, 1, 0}, 2, 2, "|b1");
  write_matrix<uint8_t>("long.npy", {0, 1, 0, 0, 0}, 2, 2, "|b1");
  write_matrix<uint8_t>("other.npy", {0, 1}, 1, 2, "|b1");
  write_matrix<uint8_t>("text.npy", {0, 1, 0, 0}, 2, 2, "|S1");
  for (const std::string name :
       {"v.npy", "nan.npy", "half.npy", "short.npy", "long.npy", "other.npy", "text.npy"}) {
    INFO(name);
    CHECK(test::error_kind([&] { read_labels(name, 2, 2); }) == ErrorKind::data);
  }
  // A shape whose size overflows, which no memory can hold.
  write_text("huge.npy", npy_header("|b1", {size_t{1} << 40, size_t{1} << 40}) + "x");
  CHECK(test::error_kind([&] {
          inspect_ground_truth({"matrix", "huge.npy"},
                               {{"", kUnknownFrames}, {{"", kUnknownFrames}}});
        }) == ErrorKind::data);
}

TEST_CASE("files that scripts convert are refused with the script, by content or name") {
  write_text("v7.bin", "MATLAB 5.0 MAT-file");
  write_text("v73.bin", "\x89HDF\r\n\x1a\n");
  write_text("old.mat", "");
  write_text("m.bin", "\x89PNG\r\n");
  write_text("m.jpg", "\xff\xd8");
  write_text("o.csv", "1, 2 ,0\n");
  write_text("g.txt", "<?xml?><gpx>");
  write_text("g.yml", "%YAML:1.0\n");
  write_text("octave.txt", "# Created by Octave 7.3.0\n# name: A\n# type: matrix\n 1 0\n 0 1\n");
  write_text("p.npy", npy_header("|O", {3}));
  for (const auto& [name, script] : {std::pair("v7.bin", "mat"),
                                     {"v73.bin", "mat"},
                                     {"old.mat", "mat"},
                                     {"m.bin", "mask"},
                                     {"m.jpg", "mask"},
                                     {"o.csv", "openseqslam2"},
                                     {"g.txt", "gpx"},
                                     {"g.yml", "openfabmap"},
                                     {"octave.txt", "mat"},
                                     {"p.npy", "vpr_bench"}}) {
    INFO(name);
    const auto read = [&, path = std::string(name)] { read_labels(path, 3, 3); };
    CHECK(test::error_kind(read) == ErrorKind::usage);
    CHECK(test::has(test::error_text(read), std::string("scripts/convert/") + script + ".py"));
  }
  const auto scores = [&] { NpyArray("v7.bin"); };
  CHECK(test::has(test::error_text(scores), "scripts/convert/mat.py"));
  CHECK(test::error_kind([&] { NpyArray("m.bin"); }) == ErrorKind::data);
  CHECK(test::has(test::error_text([] { find_format("mask"); }), "mask.py"));
}

TEST_CASE("a truncated archive is refused") {
  const InspectedGroundTruth truth = inspect_ground_truth({"aligned"}, {{"", 3}, {{"ref", 3}}});
  write_truth(find_format("matrix"), truth, "a.npz");
  const std::string whole = test::read_text("a.npz");
  for (size_t size = 4; size < whole.size(); ++size) {
    write_text("cut.npz", whole.substr(0, size));
    REQUIRE(test::error_kind([&] { read_labels("cut.npz", 3, 3); }) == ErrorKind::data);
  }
  // Any flipped bit is an error or, in names and dates, yields the same matrix.
  for (size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    write_text("bad.npz", damaged);
    std::string found;
    const auto kind = test::error_kind([&] {
      found = read_labels(GroundTruthArgument{"matrix", "bad.npz"}, 3, 3);
    });
    if (kind)
      CHECK(kind == ErrorKind::data);
    else
      CHECK(found == "S.. .S. ..S");
  }
}
