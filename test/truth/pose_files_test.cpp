// Ground truth from poses, trajectories and names with positions.
#include <cmath>
#include <limits>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/error.h"
#include "recordings/frames.h"
#include "truth/readers.h"
#include "truth/truth_files.h"

using namespace vpr;
using test::by_positions;
using test::read_labels;
using test::write_text;

TEST_CASE("poses within a radius are the same place, unknown ones are ignored") {
  write_text("q.csv", "frame,x,y\n0,0,0\n2,3,4\n");
  write_text("r.csv", "frame,x,y\n1,0,5\n0,0,5.001\n3,1e300,-1e300\n");
  GroundTruthArgument argument = by_positions("q.csv", "r.csv", 5);
  // Query 1 and reference 2 have no pose. (0,0)-(0,5) is 5 m: the bound is inclusive.
  CHECK(read_labels(argument, 3, 4) == ".Si. iiii SSi.");
  argument.options.radius_m = 0;
  CHECK(read_labels(argument, 3, 4) == "..i. iiii ..i.");
  for (const double none : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    argument.options.radius_m = none;
    CHECK(test::error_kind([&] { read_labels(argument, 3, 4); }) == ErrorKind::usage);
  }
  CHECK(test::has(test::error_text([&] { read_labels("q.csv", 3, 4); }), "--ground-truth-train"));
}

TEST_CASE("headings are circular, and both bounds are inclusive") {
  write_text("q.csv", "frame,x,y,heading\n0,0,0,350\n1,0,0,-170\n");
  write_text("r.csv", "frame,x,y,heading\n0,0,0,10\n1,0,0,170\n2,0,0,11\n");
  GroundTruthArgument argument = by_positions("q.csv", "r.csv", 25);
  argument.options.angle_deg = 20;
  CHECK(read_labels(argument, 2, 3) == "S.. .S.");
  write_text("r.csv", "frame,x,y\n0,0,0\n1,0,0\n2,0,0\n");
  CHECK(test::error_kind([&] { read_labels(argument, 2, 3); }) == ErrorKind::data);
}

TEST_CASE("ranges of pose files are those of the sequences") {
  write_text("all.csv", "frame,x,y\n0,0,0\n1,100,0\n2,200,0\n3,300,0\n4,400,0\n");
  GroundTruthArgument argument{"", "all.csv@1:5:2"};  // frames 1 and 3
  argument.options.reference = "all.csv@3:";          // frames 3 and 4
  argument.options.radius_m = 25;
  CHECK(read_labels(argument, 2, 2) == ".. S.");
  CHECK(test::error_kind([&] { read_labels(argument, 2, 1); }) == ErrorKind::data);
  // The other frames of a longer query would silently be ignored.
  CHECK(test::error_kind([&] { read_labels(argument, 3, 2); }) == ErrorKind::data);
  argument.path = "all.csv@1:";
  CHECK(read_labels(argument, 4, 2) == ".. .. S. .S");
  argument.path = "all.csv@3:";
  argument.options.reference = "all.csv";
  CHECK(test::has(read_ground_truth(argument, {{"", 3}, {{"ref", 6}}}).protocol,
                  "1 query and 1 training frames without a pose"));
  write_text("none.csv", "frame,x,y\n0,NA,\n1,nan,nan\n");
  argument.path = "none.csv";
  test::check_refused([&] { read_labels(argument, 2, 5); }, "none.csv: no frame has a known pose");
}

TEST_CASE("poses need a radius, and one that includes nearly all pairs causes a warning") {
  std::string line = "frame,x,y\n";
  for (int i = 0; i < 30; ++i) line += fmt::format("{},{},0\n", i, i);
  write_text("p.csv", line);
  GroundTruthArgument argument{"", "p.csv"};
  argument.options.reference = "p.csv";
  const GroundTruthScope scope{{"", 30}, {{"ref", 30}}};
  const std::string missing = test::error_text([&] { read_ground_truth(argument, scope); });
  CHECK(test::has(missing, "--radius 2"));
  CHECK(test::has(missing, "radius_m"));
  test::Warnings warnings;
  argument.options.radius_m = 3;  // 198 of 900 pairs
  read_ground_truth(argument, scope, warnings.monitor);
  CHECK(warnings.said.empty());
  argument.options.radius_m = 4;  // 250 of 900
  read_ground_truth(argument, scope, warnings.monitor);
  REQUIRE(warnings.said.size() == 1);
  CHECK(test::has(warnings.said[0], "within 4 m lie 28 % of all pairs"));
}

TEST_CASE("lines that begin with # may precede a header") {
  write_text("p.csv", "# made by hand\n#\nframe,x,y\n0,0,0\n1,one,0\n");
  write_text("g.csv", "# made by hand\nquery,reference\n0,1\n");
  CHECK(read_labels("g.csv", 1, 2) == ".S");
  GroundTruthArgument argument = by_positions("p.csv", "p.csv", 1);
  CHECK(test::has(test::error_text([&] { read_labels(argument, 2, 2); }), "line 5"));
}

TEST_CASE("near poses equal those of comparing all pairs") {
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
    write_text(side == 0 ? "q.csv" : "r.csv", text);
  }
  for (const double radius : {0.0, 0.25, 2.0, 5.0, 40.0}) {
    GroundTruthArgument argument = by_positions("q.csv", "r.csv", radius);
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
    CHECK(read_labels(argument, 60, 60) == expected);
  }
}

TEST_CASE("trajectories of TUM and KITTI: positions, and the angle between orientations") {
  const double half = std::sqrt(0.5);  // a quarter turn around z as a quaternion
  write_text("q.tum", "# time x y z qx qy qz qw\n1.5 0 0 0 0 0 0 1\n");
  write_text("r.tum",
             fmt::format("1 3 0 4 0 0 0 2\n2 0 0 0 0 0 {} {}\n\n3 0 0 5.01 0 0 0 1\n", half, half));
  GroundTruthArgument argument = by_positions("q.tum", "r.tum", 5);
  CHECK(read_labels(argument, 1, 3) == "SS.");
  argument.options.angle_deg = 89.9;
  CHECK(read_labels(argument, 1, 3) == "S..");
  argument.options.angle_deg = 90.1;
  CHECK(read_labels(argument, 1, 3) == "SS.");
  // The same poses as matrices, with the position in the last column.
  write_text("q.kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  write_text("r.kitti", "1 0 0 3 0 1 0 0 0 0 1 4\n0 -1 0 0 1 0 0 0 0 0 1 0\n");
  argument = by_positions("q.kitti", "r.kitti", 5);
  argument.options.angle_deg = 89.9;
  CHECK(read_labels(argument, 1, 2) == "S.");
  CHECK(test::error_kind([&] { read_labels(argument, 2, 2); }) == ErrorKind::data);
}

TEST_CASE("a KITTI matrix that is not a rotation is refused with the line") {
  write_text("r.kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  GroundTruthArgument argument = by_positions("q.kitti", "r.kitti", 5);
  const auto refusal = [&](const std::string& matrix) {
    write_text("q.kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n" + matrix + "\n");
    return test::error_text([&] { read_labels(argument, 2, 1); });
  };
  for (const char* matrix :
       {"5 0 0 0 0 5 0 0 0 0 5 0", "0 0 0 0 0 0 0 0 0 0 0 0", "1 0 0 0 0 1 0 0 0 0 -1 0",
        "1 0.1 0 0 0 1 0 0 0 0 1 0", "9e307 9e307 9e307 0 9e307 9e307 9e307 0 9e307 9e307 9e307 0"})
    CHECK(test::has(refusal(matrix), "line 2: its matrix is not a rotation"));
  // Rounded to three digits, as in some files: 30 degrees around z.
  CHECK(refusal("0.866 -0.5 0 0 0.5 0.866 0 0 0 0 1 0").empty());
}

TEST_CASE("a byte order mark before a trajectory is not part of a number") {
  write_text("q.tum", "\xef\xbb\xbf\x31 0 0 0 0 0 0 1\n");
  GroundTruthArgument argument = by_positions("q.tum", "q.tum", 5);
  CHECK(read_labels(argument, 1, 1) == "S");
}

TEST_CASE("the angle between orientations equals values computed by hand") {
  Pose a;
  Pose b;
  CHECK_FALSE(angle_between(a, b).has_value());
  a.heading_deg = -720;
  b.heading_deg = 180;
  CHECK(*angle_between(a, b) == 180);
  b.heading_deg.reset();
  CHECK_FALSE(angle_between(a, b).has_value());
}

TEST_CASE("names of images have UTM coordinates") {
  const auto name = parse_utm_name("@543256.96@4178906.70@10@S@037.75@-122.5@pano@2@90@@@@.jpg");
  REQUIRE(name.has_value());
  CHECK(name->position == std::array<double, 3>{543256.96, 4178906.70, 0});
  CHECK(name->area == "10");
  CHECK(name->heading_deg == 90);
  // the other fields may have any content
  CHECK(parse_utm_name("@1@2@frame12@.jpg")->area.empty());
  CHECK(parse_utm_name("@1@2@61@.jpg")->area.empty());
  CHECK(parse_utm_name("@1.5@2.5.jpg")->position[1] == 2.5);
  CHECK(parse_utm_name("@0@2.4@@@@@1@@@@@@@@.jpg").has_value());
  CHECK_FALSE(parse_utm_name("@1@x@.jpg").has_value());
  CHECK_FALSE(parse_utm_name("@1@nan@.jpg").has_value());
  CHECK_FALSE(parse_utm_name("1.jpg").has_value());
  CHECK_FALSE(parse_utm_name("@1").has_value());
  CHECK_FALSE(parse_utm_name("").has_value());
}

TEST_CASE("folders of images with UTM names have a default radius of 25 m") {
  std::filesystem::create_directory("q");
  std::filesystem::create_directory("r");
  // Ten frames are 25 m minus half a step: the dummy coordinates of Nordland.
  for (int i = 0; i < 12; ++i)
    write_text(fmt::format("r/@0@{:.1f}@@@@@{}@.jpg", 25 / 10.5 * i, i), "");
  write_text("q/@0@0.0@@@@@0@.jpg", "");
  GroundTruthArgument argument{"", "q"};
  argument.options.reference = "r";
  CHECK(test::has(test::error_text([&] { read_labels(argument, 1, 12); }), "--order natural"));
  const ProcessScope process({.order = FrameOrder::natural});
  CHECK(read_labels(argument, 1, 12) == "SSSSSSSSSSS.");
  CHECK(test::has(
      read_ground_truth({"", "q", 0, {"r", {}, {}, {}, {}, {}}}, {{"", 1}, {{"ref", 12}}}).protocol,
      "within 25 m, the radius of the benchmark"));
  argument.options.radius_m = 2.4;
  CHECK(read_labels(argument, 1, 12) == "SS..........");
  write_text("r/plain.jpg", "");
  CHECK(test::error_kind([&] { read_labels(argument, 1, 13); }) == ErrorKind::data);
  std::filesystem::remove("r/plain.jpg");
  write_text("q/@0@0.0@32@@@@1@.jpg", "");
  write_text("q/@0@0.0@33@@@@2@.jpg", "");
  CHECK(test::has(test::error_text([&] { read_labels(argument, 3, 12); }), "zone"));
}

TEST_CASE("images in several UTM zones are compared on the ellipsoid") {
  for (const char* folder : {"q", "r"}) std::filesystem::create_directory(folder);
  // 10.82 m west and east of 12 E, 61 N, the border of two zones; and 11.16 m around 3 E, 60 N,
  // where zone 32V is wider than others (pyproj 3.4.1).
  write_text("q/@662212.816@6766502.743@32@V@0.jpg", "");
  write_text("q/@499994.422@6651411.190@31V@@1.jpg", "");
  write_text("q/@nan@nan@32@V@2.jpg", "");
  write_text("r/@165645.895@6666593.066@32@V@0.jpg", "");
  write_text("r/@337787.184@6766502.742@33@V@1.jpg", "");
  const GroundTruthArgument argument = by_positions("q", "r", 11);
  CHECK(read_labels(argument, 3, 2) == ".. .S ii");
  CHECK(read_labels(by_positions("q", "r", 11.2), 3, 2) == "S. .S ii");
  CHECK(read_labels(by_positions("q", "r", 10.8), 3, 2) == ".. .. ii");
  write_text("r/@337787.184@6766502.742@33@@2.jpg", "");  // without a band
  CHECK(
      test::has(test::error_text([&] { read_labels(argument, 3, 3); }), "need the zone and band"));
}
