// Every format of ground truth on cases small enough to see, then at its edges.
#include <cmath>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "base/error.h"
#include "base/npy.h"
#include "ground_truth/builder.h"
#include "ground_truth/fingerprint.h"
#include "ground_truth/formats.h"
#include "ground_truth/ground_truth.h"
#include "ground_truth/label_runs.h"
#include "ground_truth/pose_matches.h"
#include "ground_truth/presets.h"
#include "ground_truth/utm_names.h"
#include "support.h"

using namespace vpr;

namespace {

/// The labels of a ground truth as one character a pair: . different, S same, i ignored.
std::string draw(const GroundTruth& truth, size_t query_frames, size_t train_frames) {
  std::string text;
  for (size_t q = 0; q < query_frames; ++q) {
    std::vector<PlaceLabel> row(train_frames);
    truth.label_row(q, 0, row);
    for (size_t r = 0; r < train_frames; ++r) {
      CHECK(truth.label(q, 0, r) == row[r]);
      text += ".Si"[static_cast<size_t>(row[r])];
    }
    if (q + 1 < query_frames) text += ' ';
  }
  return text;
}

struct Files {
  test::TemporaryFolder folder;

  std::string read(GroundTruthArgument argument, size_t query, size_t train) const {
    argument.path = folder / argument.path.string();
    if (!argument.options.reference.empty())
      argument.options.reference = folder / argument.options.reference.string();
    if (!argument.options.soft.empty())
      argument.options.soft = folder / argument.options.soft.string();
    return draw(read_ground_truth(argument, {query, {{"ref", train}}}), query, train);
  }
  std::string read(const std::string& name, size_t query, size_t train) const {
    return read(GroundTruthArgument{"", name}, query, train);
  }
  void text(const std::string& name, const std::string& content) const {
    test::write_text(folder / name, content);
  }
  template <class T>
  void matrix(const std::string& name, const std::vector<T>& values, size_t rows, size_t cols,
              std::string_view type) const {
    OutputFile file(folder / name, Existing::replace);
    file.write(npy_header(type, {rows, cols}));
    file.write(std::as_bytes(std::span<const T>(values)));
    file.commit();
  }
};

void write_truth(const GroundTruthFormat& format, const InspectedGroundTruth& truth,
                 const std::filesystem::path& path) {
  OutputFile file(path, Existing::replace);
  format.write(truth, file, {});
  file.commit();
}

}  // namespace

TEST_CASE("runs of references are labelled with their tolerance, cut off at the ends") {
  GroundTruth truth;
  truth.pairs = {{{0, 1, PlaceLabel::ignore, 2}, {0, 6, PlaceLabel::same, 1}},
                 {{0, 0, PlaceLabel::same}, {0, 1, PlaceLabel::ignore}, {0, 9, PlaceLabel::same}}};
  CHECK(draw(truth, 2, 10) == ".iii..SS.. Si.......S");
  truth.tolerance_frames = 2;
  CHECK(draw(truth, 2, 10) == ".iiiSSSSSS SSS....SSS");
  truth.tolerance_frames = 100;
  CHECK(draw(truth, 2, 10) == "SSSSSSSSSS SSSSSSSSSS");
}

TEST_CASE("labels of any runs are those of the definition") {
  uint64_t state = 7;
  const auto next = [&](uint64_t below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<uint32_t>((state >> 33) % below);
  };
  for (int round = 0; round < 200; ++round) {
    GroundTruth truth;
    truth.pairs.resize(1);
    truth.tolerance_frames = next(5);
    std::vector<PlaceLabel> exact(40, PlaceLabel::different);
    for (uint32_t at = next(4); at < 36;) {
      const auto label = next(2) == 0 ? PlaceLabel::same : PlaceLabel::ignore;
      const uint32_t further = next(4);
      truth.pairs[0].push_back({0, at, label, further});
      for (uint32_t r = at; r <= at + further; ++r) exact[r] = label;
      at += further + 1 + next(4);
    }
    for (int64_t r = 0; r < 40; ++r) {
      PlaceLabel expected = exact[static_cast<size_t>(r)];
      for (int64_t k = 0; k < 40; ++k)
        if (exact[static_cast<size_t>(k)] == PlaceLabel::same &&
            std::abs(k - r) <= truth.tolerance_frames)
          expected = PlaceLabel::same;
      REQUIRE(truth.label(0, 0, static_cast<size_t>(r)) == expected);
    }
    draw(truth, 1, 40);
  }
}

TEST_CASE("pairs are joined to runs, and found by their content") {
  const Files files;
  files.text("g.txt", "query,reference,label\n0,2,\n0,1,\n0,1,\n1,0,ignore\n");
  CHECK(files.read("g.txt", 2, 4) == ".SS. i...");
  const auto found =
      inspect_ground_truth({"", files.folder / "g.txt"}, {kUnknownFrames, {{"", kUnknownFrames}}});
  CHECK(found.format == "pairs");
  CHECK(found.scope.query_frames == 2);
  CHECK(found.scope.sequences[0].frames == 3);
  CHECK(found.findings[size_t(FindingKind::duplicate)].count == 1);
}

TEST_CASE("poses within a radius are the same place, unknown ones are ignored") {
  const Files files;
  files.text("q.csv", "frame,x,y\n0,0,0\n2,3,4\n");
  files.text("r.csv", "frame,x,y\n1,0,5\n0,0,5.001\n3,1e300,-1e300\n");
  GroundTruthArgument argument{"", "q.csv"};
  argument.options.reference = "r.csv";
  argument.options.radius_m = 5;
  // Query 1 and reference 2 have no pose. (0,0)-(0,5) is 5 m: the bound is included.
  CHECK(files.read(argument, 3, 4) == ".Si. iiii SSi.");
  argument.options.radius_m = 0;
  CHECK(files.read(argument, 3, 4) == "..i. iiii ..i.");
  argument.options.radius_m = -1;
  CHECK(test::error_kind([&] { files.read(argument, 3, 4); }) == ErrorKind::usage);
  CHECK(test::error_text([&] { files.read("q.csv", 3, 4); }).find("--ground-truth-reference") !=
        std::string::npos);
}

TEST_CASE("headings go round the circle, and both bounds are included") {
  const Files files;
  files.text("q.csv", "frame,x,y,heading\n0,0,0,350\n1,0,0,-170\n");
  files.text("r.csv", "frame,x,y,heading\n0,0,0,10\n1,0,0,170\n2,0,0,11\n");
  GroundTruthArgument argument{"poses", "q.csv"};
  argument.options.reference = "r.csv";
  argument.options.radius_m = 25;
  argument.options.angle_deg = 20;
  CHECK(files.read(argument, 2, 3) == "S.. .S.");
  files.text("r.csv", "frame,x,y\n0,0,0\n1,0,0\n2,0,0\n");
  CHECK(test::error_kind([&] { files.read(argument, 2, 3); }) == ErrorKind::data);
}

TEST_CASE("ranges of pose files are those of the sequences") {
  const Files files;
  files.text("all.csv", "frame,x,y\n0,0,0\n1,100,0\n2,200,0\n3,300,0\n4,400,0\n");
  GroundTruthArgument argument{"", "all.csv@1:5:2"};  // frames 1 and 3
  argument.options.reference = "all.csv@3:";          // frames 3 and 4
  argument.options.radius_m = 25;
  CHECK(files.read(argument, 2, 2) == ".. S.");
  CHECK(test::error_kind([&] { files.read(argument, 2, 1); }) == ErrorKind::data);
  // The other frames of a longer query would be ignored without a word.
  CHECK(test::error_kind([&] { files.read(argument, 3, 2); }) == ErrorKind::data);
  argument.path = "all.csv@1:";
  CHECK(files.read(argument, 4, 2) == ".. .. S. .S");
  argument.path = files.folder / "all.csv@3:";
  argument.options.reference = files.folder / "all.csv";
  CHECK(read_ground_truth(argument, {3, {{"ref", 6}}})
            .protocol.find("1 query and 1 training frames without a pose") != std::string::npos);
}

TEST_CASE("poses need a radius, and one that calls everything the same is warned of") {
  const Files files;
  std::string line = "frame,x,y\n";
  for (int i = 0; i < 30; ++i) line += fmt::format("{},{},0\n", i, i);
  files.text("p.csv", line);
  GroundTruthArgument argument{"", files.folder / "p.csv"};
  argument.options.reference = files.folder / "p.csv";
  const GroundTruthScope scope{30, {{"ref", 30}}};
  const std::string missing = test::error_text([&] { read_ground_truth(argument, scope); });
  CHECK(missing.find("--radius 2") != std::string::npos);
  CHECK(missing.find("radius_m") != std::string::npos);
  std::vector<std::string> warnings;
  Monitor monitor;
  monitor.warn = [&](const std::string& sentence) { warnings.push_back(sentence); };
  argument.options.radius_m = 1;  // 88 of 900 pairs
  read_ground_truth(argument, scope, monitor);
  CHECK(warnings.empty());
  argument.options.radius_m = 2;  // 144 of 900
  read_ground_truth(argument, scope, monitor);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("within 2 m lie 16 % of all pairs") != std::string::npos);
}

TEST_CASE("lines that begin with # may stand in front of a header") {
  const Files files;
  files.text("p.csv", "# made by hand\n#\nframe,x,y\n0,0,0\n1,one,0\n");
  files.text("g.csv", "# made by hand\nquery,reference\n0,1\n");
  CHECK(files.read("g.csv", 1, 2) == ".S");
  GroundTruthArgument argument{"", "p.csv"};
  argument.options.reference = "p.csv";
  argument.options.radius_m = 1;
  CHECK(test::error_text([&] { files.read(argument, 2, 2); }).find("line 5") != std::string::npos);
}

TEST_CASE("ranges of pairs are those of the query") {
  const Files files;
  files.text("g.csv", "query,reference\n0,0\n1,1\n2,2\n3,3\n4,4\n");
  CHECK(files.read("g.csv@1:4", 3, 5) == ".S... ..S.. ...S.");
  CHECK(files.read("g.csv@1:5:2", 2, 5) == ".S... ...S.");
  CHECK(files.read("g.csv@3:", 2, 5) == "...S. ....S");
  CHECK(test::error_text([&] { files.read("g.csv@1:4", 2, 5); }).find("its range has 3 frames") !=
        std::string::npos);
  const std::string beyond = test::error_text([&] { files.read("g.csv", 3, 5); });
  CHECK(beyond.find("line 5: query 3 is out of range") != std::string::npos);
  CHECK(beyond.find("g.csv@60:111") != std::string::npos);
  files.matrix<uint8_t>("m.npy", {0, 1, 0, 0}, 2, 2, "|b1");
  CHECK(test::error_kind([&] { files.read("m.npy@1:2", 1, 2); }) == ErrorKind::usage);
}

TEST_CASE("near poses are found as by comparing all with all") {
  const Files files;
  uint64_t state = 3;
  const auto coordinate = [&] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>((state >> 40) % 100) / 4;  // exact, with many ties
  };
  std::array<std::vector<std::array<double, 2>>, 2> sides;
  for (size_t side = 0; side < 2; ++side) {
    std::string text = "frame,x,y\n";
    for (int i = 0; i < 60; ++i) {
      sides[side].push_back({coordinate(), coordinate()});
      text += fmt::format("{},{},{}\n", i, sides[side][i][0], sides[side][i][1]);
    }
    files.text(side == 0 ? "q.csv" : "r.csv", text);
  }
  for (const double radius : {0.0, 0.25, 2.0, 5.0, 40.0}) {
    GroundTruthArgument argument{"poses", "q.csv"};
    argument.options.reference = "r.csv";
    argument.options.radius_m = radius;
    std::string expected;
    for (const auto& q : sides[0]) {
      for (const auto& r : sides[1]) {
        const double x = q[0] - r[0];
        const double y = q[1] - r[1];
        expected += x * x + y * y <= radius * radius ? 'S' : '.';
      }
      expected += ' ';
    }
    expected.pop_back();
    CHECK(files.read(argument, 60, 60) == expected);
  }
}

TEST_CASE("trajectories of TUM and KITTI: positions, and the angle between orientations") {
  const Files files;
  const double half = std::sqrt(0.5);  // a quarter turn about z as a quaternion
  files.text("q.tum", "# time x y z qx qy qz qw\n1.5 0 0 0 0 0 0 1\n");
  files.text("r.tum",
             fmt::format("1 3 0 4 0 0 0 2\n2 0 0 0 0 0 {} {}\n\n3 0 0 5.01 0 0 0 1\n", half, half));
  GroundTruthArgument argument{"", "q.tum"};
  argument.options.reference = "r.tum";
  argument.options.radius_m = 5;
  CHECK(files.read(argument, 1, 3) == "SS.");
  argument.options.angle_deg = 89.9;
  CHECK(files.read(argument, 1, 3) == "S..");
  argument.options.angle_deg = 90.1;
  CHECK(files.read(argument, 1, 3) == "SS.");
  // The same as matrices: position in the last column.
  files.text("q.kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  files.text("r.kitti", "1 0 0 3 0 1 0 0 0 0 1 4\n0 -1 0 0 1 0 0 0 0 0 1 0\n");
  argument = {"", "q.kitti"};
  argument.options.reference = "r.kitti";
  argument.options.angle_deg = 89.9;
  argument.options.radius_m = 5;
  CHECK(files.read(argument, 1, 2) == "S.");
  CHECK(test::error_kind([&] { files.read(argument, 2, 2); }) == ErrorKind::data);
}

TEST_CASE("a matrix of KITTI that is no rotation is refused with its line") {
  const Files files;
  files.text("r.kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  GroundTruthArgument argument{"", "q.kitti"};
  argument.options.reference = "r.kitti";
  argument.options.radius_m = 5;
  const auto refusal = [&](const std::string& matrix) {
    files.text("q.kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n" + matrix + "\n");
    return test::error_text([&] { files.read(argument, 2, 1); });
  };
  for (const char* matrix :
       {"5 0 0 0 0 5 0 0 0 0 5 0", "0 0 0 0 0 0 0 0 0 0 0 0", "1 0 0 0 0 1 0 0 0 0 -1 0",
        "1 0.1 0 0 0 1 0 0 0 0 1 0", "9e307 9e307 9e307 0 9e307 9e307 9e307 0 9e307 9e307 9e307 0"})
    CHECK(refusal(matrix).find("line 2: its matrix is no rotation") != std::string::npos);
  // Rounded to three digits, as some write them: 30 degrees about z.
  CHECK(refusal("0.866 -0.5 0 0 0.5 0.866 0 0 0 0 1 0").empty());
}

TEST_CASE("a byte order mark in front of trajectories is no part of a number") {
  const Files files;
  files.text("q.tum", "\xef\xbb\xbf\x31 0 0 0 0 0 0 1\n");
  GroundTruthArgument argument{"", "q.tum"};
  argument.options.reference = "q.tum";
  argument.options.radius_m = 5;
  CHECK(files.read(argument, 1, 1) == "S");
}

TEST_CASE("an archive without any file is damaged ground truth") {
  const Files files;
  files.text("none.npz", std::string("PK\x05\x06") + std::string(18, '\0'));
  CHECK(test::error_kind([&] { files.read("none.npz", 1, 1); }) == ErrorKind::data);
}

TEST_CASE("the angle between orientations") {
  Pose a;
  Pose b;
  CHECK_FALSE(angle_between(a, b).has_value());
  a.heading_deg = -720;
  b.heading_deg = 180;
  CHECK(*angle_between(a, b) == 180);
  b.heading_deg.reset();
  CHECK_FALSE(angle_between(a, b).has_value());
}

TEST_CASE("names of images carry UTM coordinates") {
  const auto name = parse_utm_name("@543256.96@4178906.70@10@S@037.75@-122.5@pano@2@90@@@@.jpg");
  REQUIRE(name.has_value());
  CHECK(name->pose.position == std::array<double, 3>{543256.96, 4178906.70, 0});
  CHECK(name->zone == "10");
  CHECK(name->pose.heading_deg == 90);
  CHECK(parse_utm_name("@1.5@2.5.jpg")->pose.position[1] == 2.5);
  CHECK(parse_utm_name("@0@2.4@@@@@1@@@@@@@@.jpg").has_value());
  CHECK_FALSE(parse_utm_name("@1@x@.jpg").has_value());
  CHECK_FALSE(parse_utm_name("@1@nan@.jpg").has_value());
  CHECK_FALSE(parse_utm_name("1.jpg").has_value());
  CHECK_FALSE(parse_utm_name("@1").has_value());
  CHECK_FALSE(parse_utm_name("").has_value());
}

TEST_CASE("folders of such images: 25 m unless something else is said") {
  const Files files;
  std::filesystem::create_directory(files.folder / "q");
  std::filesystem::create_directory(files.folder / "r");
  // Ten frames are 25 m less a half step: the dummy coordinates of Nordland.
  for (int i = 0; i < 12; ++i)
    files.text(fmt::format("r/@0@{:.1f}@@@@@{}@.jpg", 25 / 10.5 * i, i), "");
  files.text("q/@0@0.0@@@@@0@.jpg", "");
  GroundTruthArgument argument{"", "q"};
  argument.options.reference = "r";
  // Natural order sorts by the numbers in the names, as it does for the frames themselves.
  CHECK(files.read(argument, 1, 12) == "SSSSSSSSSSS.");
  CHECK(read_ground_truth({"", files.folder / "q", 0, {files.folder / "r", {}, {}, {}, {}, {}}},
                          {1, {{"ref", 12}}})
            .protocol.find("within 25 m, the radius of the benchmark") != std::string::npos);
  argument.options.radius_m = 2.4;
  CHECK(files.read(argument, 1, 12) == "SS..........");
  files.text("r/plain.jpg", "");
  CHECK(test::error_kind([&] { files.read(argument, 1, 13); }) == ErrorKind::data);
  files.text("q/@0@0.0@32@@@@1@.jpg", "");
  files.text("q/@0@0.0@33@@@@2@.jpg", "");
  CHECK(test::error_text([&] { files.read(argument, 3, 13); }).find("zone") != std::string::npos);
}

TEST_CASE("OpenSeqSLAM counts from one, and has a tolerance for every pair") {
  const Files files;
  files.text("g.csv", "1,1,1\n2, 3 ,0\n3,4,9\n");
  CHECK(files.read("g.csv", 3, 4) == "SS.. ..S. SSSS");
  GroundTruthArgument argument{"openseqslam2", "g.csv", 1};
  CHECK(files.read(argument, 3, 4) == "SSS. .SSS SSSS");
  for (const std::string bad : {"0,1,0\n", "1,0,0\n", "4,1,0\n", "1,5,0\n", "1,1,-1\n", "1\n",
                                "1,1,1,1\n", "1,x,0\n", "1,1.5,0\n", ""}) {
    files.text("b.csv", bad);
    argument.path = "b.csv";
    INFO(bad);
    CHECK(test::error_kind([&] { files.read(argument, 3, 4); }) == ErrorKind::data);
  }
}

TEST_CASE("matrices of any number type, with a soft one") {
  const Files files;
  files.matrix<uint8_t>("b.npy", {1, 0, 0, 0, 1, 0}, 2, 3, "|b1");
  files.matrix<double>("d.npy", {1, 0, 0, 0, 1, 0}, 2, 3, "<f8");
  files.matrix<int64_t>("i.npy", {1, 0, 0, 0, 1, 0}, 2, 3, "<i8");
  files.matrix<uint8_t>("soft.npy", {1, 1, 0, 0, 0, 1}, 2, 3, "|b1");
  for (const std::string name : {"b.npy", "d.npy", "i.npy"}) {
    CHECK(files.read(name, 2, 3) == "S.. .S.");
    CHECK(files.read(name, 3, 2) == "S. .S ..");  // only the other way fits
  }
  GroundTruthArgument argument{"", "b.npy"};
  argument.options.soft = "soft.npy";
  CHECK(files.read(argument, 2, 3) == "Si. .Si");
  argument.options.matrix_rows = MatrixRows::reference;
  CHECK(files.read(argument, 3, 2) == "S. iS .i");
  CHECK(test::error_kind([&] { files.read(argument, 2, 3); }) == ErrorKind::data);
  files.matrix<uint8_t>("soft.npy", {1, 1, 0, 0, 0, 1}, 3, 2, "|b1");
  CHECK(test::error_kind([&] { files.read(argument, 3, 2); }) == ErrorKind::data);
}

TEST_CASE("square matrices are read by rows of queries, or as they say") {
  const Files files;
  files.matrix<uint8_t>("s.npy", {0, 1, 0, 0}, 2, 2, "|u1");
  CHECK(files.read("s.npy", 2, 2) == ".S ..");
  GroundTruthArgument argument{"", "s.npy"};
  argument.options.matrix_rows = MatrixRows::reference;
  CHECK(files.read(argument, 2, 2) == ".. S.");
  // Fortran order: the same bytes are the transposed matrix.
  std::string header = npy_header("|u1", {2, 2});
  header.replace(header.find("False,"), 6, "True, ");
  files.text("f.npy", header + std::string("\0\1\0\0", 4));
  CHECK(files.read("f.npy", 2, 2) == ".. S.");
}

TEST_CASE("matrices that are none") {
  const Files files;
  files.matrix<uint8_t>("v.npy", {0, 2, 0, 0}, 2, 2, "|u1");
  files.matrix<float>("nan.npy", {0, NAN, 0, 0}, 2, 2, "<f4");
  files.matrix<float>("half.npy", {0, 0.5f, 0, 0}, 2, 2, "<f4");
  files.matrix<uint8_t>("short.npy", {0, 1, 0}, 2, 2, "|b1");
  files.matrix<uint8_t>("long.npy", {0, 1, 0, 0, 0}, 2, 2, "|b1");
  files.matrix<uint8_t>("other.npy", {0, 1}, 1, 2, "|b1");
  files.matrix<uint8_t>("text.npy", {0, 1, 0, 0}, 2, 2, "|S1");
  for (const std::string name :
       {"v.npy", "nan.npy", "half.npy", "short.npy", "long.npy", "other.npy", "text.npy"}) {
    INFO(name);
    CHECK(test::error_kind([&] { files.read(name, 2, 2); }) == ErrorKind::data);
  }
  // A shape whose size overflows, and one that nobody has memory for.
  files.text("huge.npy", npy_header("|b1", {size_t{1} << 40, size_t{1} << 40}) + "x");
  CHECK(test::error_kind([&] {
          inspect_ground_truth({"matrix", files.folder / "huge.npy"},
                               {kUnknownFrames, {{"", kUnknownFrames}}});
        }) == ErrorKind::data);
}

TEST_CASE("masks are white, black and grey") {
  const Files files;
  const auto write = [&](const std::string& name, const cv::Mat& image) {
    cv::imwrite((files.folder / name).string(), image);
  };
  write("m.png", (cv::Mat_<uint8_t>(2, 3) << 255, 1, 0, 0, 254, 255));
  CHECK(files.read("m.png", 2, 3) == "Si. .iS");
  CHECK(files.read("m.png", 3, 2) == "S. ii .S");
  write("m.jpg", cv::Mat::zeros(2, 3, CV_8U));
  CHECK(test::error_text([&] { files.read("m.jpg", 2, 3); }).find("JPEG") != std::string::npos);
  CHECK(test::error_kind([&] { files.read("m.png", 2, 2); }) == ErrorKind::data);
  const std::string png = test::read_text(files.folder / "m.png");
  files.text("cut.png", png.substr(0, png.size() / 2));
  CHECK(test::error_kind([&] { files.read("cut.png", 2, 3); }) == ErrorKind::data);
}

TEST_CASE("aligned sequences may be sampled differently") {
  GroundTruthArgument argument{"aligned", {}, 1};
  argument.options.reference_step = 2.5;  // 0, 2.5, 5: to 0, 3, 5
  CHECK(draw(read_ground_truth(argument, {3, {{"ref", 7}}}), 3, 7) == "SS..... ..SSS.. ....SSS");
  argument.options.reference_step = 0;
  CHECK(test::error_kind([&] {
          read_ground_truth(argument, {3, {{"ref", 7}}});
        }) == ErrorKind::usage);
}

TEST_CASE("presets are aligned within their tolerance, with the step of their data set") {
  const auto reach = [](const std::string& name, size_t query, size_t train) {
    const GroundTruth truth = read_ground_truth({name}, {query, {{"ref", train}}});
    return std::pair(draw(truth, query, train).substr(0, train), truth.protocol);
  };
  CHECK(reach("nordland-exact", 3, 12).first == "S...........");
  CHECK(reach("nordland-patch-netvlad", 3, 12).first == "SSS.........");
  CHECK(reach("nordland-25m", 3, 12).first == "SSSSSSSSSSS.");
  const GroundTruth tenth = read_ground_truth({"nordland-vpr-bench"}, {3, {{"ref", 22}}});
  CHECK(draw(tenth, 3, 22) ==
        "SS.................... .........SSS.......... ...................SSS");
  const GroundTruth alike = read_ground_truth({"nordland-vpr-bench"}, {3, {{"ref", 4}}});
  CHECK(draw(alike, 3, 4) == "SS.. SSS. .SSS");
  CHECK(tenth.protocol.find("10 i") != std::string::npos);
  CHECK(alike.protocol.find("training frame i,") != std::string::npos);
  CHECK(find_presets("nordland-all").size() == ground_truth_presets().size());
  CHECK(find_presets("nordland-25m,nordland-exact").size() == 2);
  CHECK(test::error_kind([] { find_presets("nordland-25m,"); }) == ErrorKind::usage);
  CHECK(test::error_kind([] { find_presets("-all"); }) == ErrorKind::usage);
}

TEST_CASE("what can't be recognised, or has no effect, is a usage error") {
  const Files files;
  files.text("what.txt", "hello world\n");
  CHECK(test::error_kind([&] { files.read("what.txt", 2, 2); }) == ErrorKind::usage);
  files.text("what.csv", "hello,world\n");
  CHECK(test::error_kind([&] { files.read("what.csv", 2, 2); }) == ErrorKind::data);
  CHECK(test::error_kind([&] { files.read("missing", 2, 2); }) == ErrorKind::input);
  CHECK(test::error_text([] {
          read_ground_truth({"pair", "x"}, {});
        }).find("pairs") != std::string::npos);
  CHECK(test::error_kind([] { read_ground_truth({"pairs"}, {}); }) == ErrorKind::usage);
  files.text("g.csv", "query,reference\n");
  GroundTruthArgument argument{"", "g.csv"};
  argument.options.radius_m = 3;
  CHECK(test::error_text([&] { files.read(argument, 2, 2); }).find("radius_m") !=
        std::string::npos);
}

TEST_CASE("every format that is written is read back, tolerance included") {
  const Files files;
  files.text("g.csv", "query,reference,label\n0,0,\n0,1,\n1,3,\n1,1,ignore\n3,5,ignore\n3,0,\n");
  const InspectedGroundTruth truth =
      inspect_ground_truth({"pairs", files.folder / "g.csv", 1}, {4, {{"ref", 6}}});
  const std::string all = "SSS... .iSSS. ...... SS...i";
  REQUIRE(draw(truth.truth, 4, 6) == all);
  std::string without_ignored = all;
  for (char& c : without_ignored) c = c == 'i' ? '.' : c;
  for (const GroundTruthFormat& format : ground_truth_formats()) {
    if (format.write == nullptr) continue;
    for (const std::string name : {"o.npz", "o.npy"}) {
      INFO(format.name << " " << name);
      write_truth(format, truth, files.folder / name);
      const bool is_whole = format.holds_ignored && (format.name != "matrix" || name == "o.npz");
      CHECK(files.read(name, 4, 6) == (is_whole ? all : without_ignored));
    }
  }
  // The same bytes every time, dates included.
  write_truth(find_format("matrix"), truth, files.folder / "a.npz");
  write_truth(find_format("matrix"), truth, files.folder / "b.npz");
  CHECK(test::read_text(files.folder / "a.npz") == test::read_text(files.folder / "b.npz"));
}

TEST_CASE("an archive that is cut off anywhere is refused") {
  const Files files;
  const InspectedGroundTruth truth = inspect_ground_truth({"aligned"}, {3, {{"ref", 3}}});
  write_truth(find_format("matrix"), truth, files.folder / "a.npz");
  const std::string whole = test::read_text(files.folder / "a.npz");
  for (size_t size = 4; size < whole.size(); ++size) {
    files.text("cut.npz", whole.substr(0, size));
    REQUIRE(test::error_kind([&] { files.read("cut.npz", 3, 3); }) == ErrorKind::data);
  }
  // A flipped bit anywhere gives an error or, in names and dates, the same matrix.
  for (size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    files.text("bad.npz", damaged);
    std::string found;
    const auto kind = test::error_kind([&] {
      found = files.read(GroundTruthArgument{"matrix", "bad.npz"}, 3, 3);
    });
    if (kind)
      CHECK(kind == ErrorKind::data);
    else
      CHECK(found == "S.. .S. ..S");
  }
}

TEST_CASE("a check counts what reading refuses") {
  const Files files;
  files.text("g.csv", "query,reference,label\n0,0,\n0,0,\n5,0,\n0,9,\n-1,0,\n1,1,ignore\n1,1,\n");
  const InspectedGroundTruth found =
      inspect_ground_truth({"", files.folder / "g.csv"}, {2, {{"ref", 3}}});
  CHECK(found.findings[size_t(FindingKind::out_of_range)].count == 3);
  CHECK(found.findings[size_t(FindingKind::out_of_range)].examples[0] ==
        "line 4: query 5 is out of range; there are 2 frames (0 to 1)");
  CHECK(found.findings[size_t(FindingKind::contradiction)].count == 1);
  CHECK(found.findings[size_t(FindingKind::duplicate)].count == 1);
  CHECK(draw(found.truth, 2, 3) == "S.. .S.");
}

TEST_CASE("labels that overlap are counted against the runs that they overlap") {
  // A run of 0 to 9 that is the same, 2 to 12 to ignore, and then 5 to 8 and 5 to 11 the same
  // again.
  const GroundTruthArgument argument{"pairs", "made up"};
  GroundTruthBuilder builder(argument, {1, {{"ref", 20}}}, InconsistentPairs::count, {});
  builder.add(0, 0, 0, 9, PlaceLabel::same);
  builder.add(0, 0, 2, 12, PlaceLabel::ignore);
  builder.add(0, 0, 5, 8, PlaceLabel::same);
  builder.add(0, 0, 5, 11, PlaceLabel::same);
  const InspectedGroundTruth found = builder.finish("");
  CHECK(found.findings[size_t(FindingKind::contradiction)].count == 8 + 2);
  CHECK(found.findings[size_t(FindingKind::duplicate)].count == 4 + 5);
  CHECK(found.findings[size_t(FindingKind::duplicate)].examples[0].find("reference 5 is given") !=
        std::string::npos);
  CHECK(draw(found.truth, 1, 14) == "SSSSSSSSSSiii.");
}

TEST_CASE("runs of labels are those of the definition") {
  uint64_t state = 11;
  const auto next = [&](uint64_t below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<uint32_t>((state >> 33) % below);
  };
  for (int round = 0; round < 300; ++round) {
    GroundTruth truth;
    truth.pairs.resize(1);
    truth.tolerance_frames = next(6);
    for (uint32_t at = next(4); at < 44;) {
      const auto label = next(2) == 0 ? PlaceLabel::same : PlaceLabel::ignore;
      truth.pairs[0].push_back({0, at, label, next(5)});
      at += truth.pairs[0].back().further + 1 + next(3);
    }
    std::string drawn(40, '.');
    size_t end = 0;
    for (const LabelRun& run : label_runs(truth, 0, 0, 40)) {
      CHECK(run.first >= end);
      end = run.last + 1;
      REQUIRE(end <= 40);
      for (size_t r = run.first; r <= run.last; ++r)
        drawn[r] = ".Si"[static_cast<size_t>(run.label)];
    }
    REQUIRE(drawn == draw(truth, 1, 40));
  }
}

TEST_CASE("a fingerprint is of what is said of every pair, not of how") {
  const Files files;
  const auto fingerprint = [&](GroundTruthArgument argument, const GroundTruthScope& scope) {
    if (!argument.path.empty()) argument.path = files.folder / argument.path.string();
    return ground_truth_fingerprint(read_ground_truth(argument, scope), scope);
  };
  const GroundTruthScope one{3, {{"ref", 4}}};
  const std::string aligned = fingerprint({"aligned", {}, 1}, one);
  files.text("a.csv", "query,reference\n0,0\n1,1\n2,2\n");
  files.text("b.csv", "query,reference\n2,3\n2,1\n2,2\n1,2\n1,1\n1,0\n0,1\n0,0\n");
  files.matrix<uint8_t>("m.npy", {1, 1, 0, 0, 1, 1, 1, 0, 0, 1, 1, 1}, 3, 4, "|b1");
  CHECK(fingerprint({"", "a.csv", 1}, one) == aligned);
  CHECK(fingerprint({"", "b.csv"}, one) == aligned);
  CHECK(fingerprint({"", "m.npy"}, one) == aligned);
  CHECK(fingerprint({"", "a.csv"}, one) != aligned);
  CHECK(fingerprint({"aligned", {}, 2}, one) != aligned);
  // Names, and sequences that were not searched or have no pair, change nothing.
  CHECK(fingerprint({"aligned", {}, 1}, {3, {{"other", 9, false}, {"references", 4}}}) == aligned);
  files.text("s.csv", "query,sequence,reference\n0,ref,0\n1,ref,1\n2,ref,2\n");
  CHECK(fingerprint({"", "s.csv", 1}, {3, {{"ref", 4}, {"more", 7}}}) == aligned);
  CHECK(fingerprint({"", "s.csv", 1}, {3, {{"more", 7}, {"ref", 4}}}) != aligned);
  files.text("i.csv", "query,reference,label\n0,0,\n1,1,\n2,2,\n0,3,ignore\n");
  CHECK(fingerprint({"", "i.csv", 1}, one) != aligned);
}

TEST_CASE("one large index does not make a file large") {
  const Files files;
  files.text("g.csv", "query,reference\n4000000000,0\n");
  CHECK(test::error_kind([&] {
          inspect_ground_truth({"", files.folder / "g.csv"},
                               {kUnknownFrames, {{"", kUnknownFrames}}});
        }) == ErrorKind::data);
}
