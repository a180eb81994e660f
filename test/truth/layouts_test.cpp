// Trajectories in the layouts of SLAM systems and data sets: five lines of each, in their original
// form.
#include "truth/layouts.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "truth/truth_files.h"

using namespace vpr;
using test::by_positions;
using test::check_refused;
using test::read_labels;
using test::write_text;

namespace {

/// A file, and two of its five poses.
struct Example {
  std::string_view layout;
  std::string text;
  std::array<double, 3> first;
  std::array<double, 3> last;
  bool has_orientation = true;
  int64_t duration_ns = 0;  ///< 0: without times
};

constexpr int64_t kTenthSteps = 400'000'000;

const std::vector<Example>& examples() {
  static const std::vector<Example> kExamples = {
      {"tum",
       "# ground truth trajectory\n# timestamp tx ty tz qx qy qz qw\n"
       "1305031098.6659 1.3563 0.6305 1.6380 0.6132 0.5962 -0.3311 -0.3986\n"
       "1305031098.7659 1.3543 0.6306 1.6360 0.6129 0.5966 -0.3316 -0.3980\n"
       "1305031098.8659 1.3510 0.6303 1.6338 0.6127 0.5968 -0.3319 -0.3978\n"
       "1305031098.9659 1.3480 0.6298 1.6317 0.6121 0.5975 -0.3321 -0.3976\n"
       "1305031099.0659 1.3451 0.6293 1.6294 0.6115 0.5982 -0.3323 -0.3973\n",
       {1.3563, 0.6305, 1.6380},
       {1.3451, 0.6293, 1.6294},
       true,
       kTenthSteps},
      {"tum",  // SaveTrajectoryEuRoC of ORB-SLAM3
       "1403636579763555584.000000 0.10 0.20 0.30 0.0 0.0 0.0 1.0\n"
       "1403636579863555584.000000 0.11 0.20 0.30 0.0 0.0 0.1 0.995\n"
       "1403636579963555584.000000 0.12 0.20 0.30 0.0 0.0 0.1 0.995\n"
       "1403636580063555584.000000 0.13 0.20 0.30 0.0 0.0 0.1 0.995\n"
       "1403636580163555584.000000 0.14 0.20 0.30 0.0 0.0 0.1 0.995\n",
       {0.1, 0.2, 0.3},
       {0.14, 0.2, 0.3},
       true,
       kTenthSteps},
      {"rtabmap",
       "#timestamp x y z qx qy qz qw id\n"
       "1588149425.100000 1 2 3 0 0 0 1 1\n1588149425.200000 2 2 3 0 0 0 1 2\n"
       "1588149425.300000 3 2 3 0 0 0 1 3\n1588149425.400000 4 2 3 0 0 0 1 4\n"
       "1588149425.500000 5 2 3 0 0 0 1 5\n",
       {1, 2, 3},
       {5, 2, 3},
       true,
       kTenthSteps},
      {"openvins",
       "# timestamp(s) tx ty tz qx qy qz qw Pr11 Pr12 Pr13 Pr22 Pr23 Pr33 Pt11 Pt12 Pt13 Pt22 Pt23 "
       "Pt33\n"
       "1403636580.1 1 0 0 0 0 0 1 .1 0 0 .1 0 .1 .1 0 0 .1 0 .1\n"
       "1403636580.2 2 0 0 0 0 0 1 .1 0 0 .1 0 .1 .1 0 0 .1 0 .1\n"
       "1403636580.3 3 0 0 0 0 0 1 .1 0 0 .1 0 .1 .1 0 0 .1 0 .1\n"
       "1403636580.4 4 0 0 0 0 0 1 .1 0 0 .1 0 .1 .1 0 0 .1 0 .1\n"
       "1403636580.5 5 0 0 0 0 0 1 .1 0 0 .1 0 .1 .1 0 0 .1 0 .1\n",
       {1, 0, 0},
       {5, 0, 0},
       true,
       kTenthSteps},
      {"kitti",
       "1.000000e+00 9.043680e-12 2.326809e-11 5.551115e-17 9.043683e-12 1.000000e+00 2.392370e-10 "
       "3.330669e-16 2.326810e-11 2.392370e-10 9.999999e-01 -4.440892e-16\n"
       "1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 0 0 1 0 0 0 0 1 2\n1 0 0 0 0 1 0 0 0 0 1 3\n"
       "1 0 0 0.5 0 1 0 0.25 0 0 1 4\n",
       {5.551115e-17, 3.330669e-16, -4.440892e-16},
       {0.5, 0.25, 4}},
      {"kitti",
       "1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\n1 0 0 2 0 1 0 2 0 0 1 3 0 0 0 1\n"
       "1 0 0 3 0 1 0 2 0 0 1 3 0 0 0 1\n1 0 0 4 0 1 0 2 0 0 1 3 0 0 0 1\n"
       "1 0 0 5 0 1 0 2 0 0 1 3 0 0 0 1\n",
       {1, 2, 3},
       {5, 2, 3}},
      {"kitti-360",
       "0 1 0 0 1 0 1 0 2 0 0 1 3\n1 1 0 0 2 0 1 0 2 0 0 1 3\n2 1 0 0 3 0 1 0 2 0 0 1 3\n"
       "3 1 0 0 4 0 1 0 2 0 0 1 3\n4 1 0 0 5 0 1 0 2 0 0 1 3 \n",
       {1, 2, 3},
       {5, 2, 3}},
      {"4seasons",
       "# frame_id, translation (t_x, t_y, t_z), rotation quaternion (q_x, q_y, q_z, w), scale, "
       "fusion quality (not relevant), v3 (not relevant)\n"
       "1586348717000000000,1,2,3,0,0,0.6,0.8,0.97,1,1\n"
       "1586348717100000000,2,2,3,0,0,0.6,0.8,0.97,1,1\n"
       "1586348717200000000,3,2,3,0,0,0.6,0.8,0.97,1,1\n"
       "1586348717300000000,4,2,3,0,0,0.6,0.8,0.97,1,1\n"
       "1586348717400000000,5,2,3,0,0,0.6,0.8,0.97,1,1\n",
       {1, 2, 3},
       {5, 2, 3},
       true,
       kTenthSteps},
      {"euroc",
       "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
       "q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], "
       "b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], "
       "b_a_RS_S_z [m s^-2]\n"
       "1403636580000000000,4.6,-1.7,0.7,0.8,0,0,0.6,0,0,0,0,0,0,0,0,0\n"
       "1403636580100000000,4.7,-1.7,0.7,0.8,0,0,0.6,0,0,0,0,0,0,0,0,0\n"
       "1403636580200000000,4.8,-1.7,0.7,0.8,0,0,0.6,0,0,0,0,0,0,0,0,0\n"
       "1403636580300000000,4.9,-1.7,0.7,0.8,0,0,0.6,0,0,0,0,0,0,0,0,0\n"
       "1403636580400000000,5.0,-1.7,0.7,0.8,0,0,0.6,0,0,0,0,0,0,0,0,0\n",
       {4.6, -1.7, 0.7},
       {5, -1.7, 0.7},
       true,
       kTenthSteps},
      {"euroc",  // VINS-Fusion, whose lines end with a comma
       "1403636580000000000,1,2,3,1,0,0,0,0.1,0,0,\n1403636580100000000,2,2,3,1,0,0,0,0.1,0,0,\n"
       "1403636580200000000,3,2,3,1,0,0,0,0.1,0,0,\n1403636580300000000,4,2,3,1,0,0,0,0.1,0,0,\n"
       "1403636580400000000,5,2,3,1,0,0,0,0.1,0,0,\n",
       {1, 2, 3},
       {5, 2, 3},
       true,
       kTenthSteps},
      {"tiers",
       "1640000000000000000,1,2,3,0.01,0.02,1.5,0,0,0.6816,0.7317\n"
       "1640000000100000000,2,2,3,0.01,0.02,1.5,0,0,0.6816,0.7317\n"
       "1640000000200000000,3,2,3,0.01,0.02,-0.2,0,0,-0.0998,0.9950\n"
       "1640000000300000000,4,2,3,0.01,0.02,-0.2,0,0,-0.0998,0.9950\n"
       "1640000000400000000,5,2,3,0.01,0.02,-0.2,0,0,-0.0998,0.9950\n",
       {1, 2, 3},
       {5, 2, 3},
       true,
       kTenthSteps},
      {"nclt",
       "1326030975726043,1,2,3,0.01,-0.02,3.1\n1326030975826043,2,2,3,0.01,-0.02,3.1\n"
       "1326030975926043,3,2,3,0.01,-0.02,3.1\n1326030976026043,4,2,3,0.01,-0.02,3.1\n"
       "1326030976126043,5,2,3,0.01,-0.02,-3.1\n",
       {1, 2, 3},
       {5, 2, 3},
       true,
       kTenthSteps},
      {"tartanair",
       "1 2 3 0 0 0.6 0.8\n2 2 3 0 0 0.6 0.8\n3 2 3 0 0 0.6 0.8\n4 2 3 0 0 0.6 0.8\n"
       "5 2 3 0 0 0.6 0.8\n",
       {1, 2, 3},
       {5, 2, 3}},
      {"leica",
       "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m]\n"
       "1403636578913555456,4.7,-1.8,0.8\n1403636579013555456,4.8,-1.8,0.8\n"
       "1403636579113555456,4.9,-1.8,0.8\n1403636579213555456,5.0,-1.8,0.8\n"
       "1403636579313555456,5.1,-1.8,0.8\n",
       {4.7, -1.8, 0.8},
       {5.1, -1.8, 0.8},
       false,
       kTenthSteps},
      {"mulran",
       "1561000444000000000,0,-1,0,355000.5,1,0,0,4025000,0,0,1,20\n"
       "1561000444100000000,0,-1,0,355001.5,1,0,0,4025000,0,0,1,20\n"
       "1561000444200000000,0,-1,0,355002.5,1,0,0,4025000,0,0,1,20\n"
       "1561000444300000000,0,-1,0,355003.5,1,0,0,4025000,0,0,1,20\n"
       "1561000444400000000,0,-1,0,355004.5,1,0,0,4025000,0,0,1,20\n",
       {355000.5, 4025000, 20},
       {355004.5, 4025000, 20},
       true,
       kTenthSteps},
      {"newer-college",
       "#sec,nsec,x,y,z,qx,qy,qz,qw\n"
       "1583836591,100000000,1,2,3,0,0,0,1\n1583836591,200000000,2,2,3,0,0,0,1\n"
       "1583836591,300000000,3,2,3,0,0,0,1\n1583836591,400000000,4,2,3,0,0,0,1\n"
       "1583836591,500000000,5,2,3,0,0,0,1\n",
       {1, 2, 3},
       {5, 2, 3},
       true,
       kTenthSteps},
      // Cameras at x = 1 to 5, which are turned by a half around z.
      {"kapture",
       "# kapture format: 1.1\n# timestamp, device_id, qw, qx, qy, qz, tx, ty, tz\n"
       "0, cam0, 0, 0, 0, 1, 1, 2, -3\n1, cam0, 0, 0, 0, 1, 2, 2, -3\n"
       "2, cam0, 0, 0, 0, 1, 3, 2, -3\n3, cam0, 0, 0, 0, 1, 4, 2, -3\n"
       "4, cam0, 0, 0, 0, 1, 5, 2, -3\n",
       {1, 2, 3},
       {5, 2, 3},
       true,
       4'000'000'000},
      {"lamar",
       "# timestamp, device_id, qw, qx, qy, qz, tx, ty, tz, *covar\n"
       "100000, cam, 0.8, 0, 0, 0.6, 1, 2, 3\n200000, cam, 0.8, 0, 0, 0.6, 2, 2, 3\n"
       "300000, cam, 0.8, 0, 0, 0.6, 3, 2, 3\n400000, cam, 0.8, 0, 0, 0.6, 4, 2, 3\n"
       "500000, cam, 0.8, 0, 0, 0.6, 5, 2, 3\n",
       {1, 2, 3},
       {5, 2, 3},
       true,
       kTenthSteps},
      {"hloc",  // cameras as in the example of kapture
       "query/3.jpg 0 0 0 1 1 2 -3\nquery/1.jpg 0 0 0 1 2 2 -3\nquery/2.jpg 0 0 0 1 3 2 -3\n"
       "query/4.jpg 0 0 0 1 4 2 -3\nquery/0.jpg 0 0 0 1 5 2 -3\n",
       {1, 2, 3},
       {5, 2, 3}},
      {"g2o",
       "VERTEX_SE3:QUAT 0 1 2 3 0 0 0 1\nVERTEX_SE3:QUAT 2 3 2 3 0 0 0 1\n"
       "VERTEX_SE3:QUAT 1 2 2 3 0 0 0 1\nVERTEX_SE3:QUAT 3 4 2 3 0 0 0 1\n"
       "VERTEX_TRACKXYZ 9 0 0 0\nVERTEX_SE3:QUAT 4 5 2 3 0 0 0 1\nFIX 0\n"
       "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n",
       {1, 2, 3},
       {5, 2, 3}},
      {"g2o-2d",
       "VERTEX_SE2 0 1 2 0\nVERTEX_SE2 1 2 2 1.570796\nVERTEX_SE2 2 3 2 0\nVERTEX_SE2 3 4 2 0\n"
       "VERTEX_SE2 4 5 2 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n",
       {1, 2, 0},
       {5, 2, 0}},
      {"table",  // odometry.csv of StrayScanner
       "timestamp, frame, x, y, z, qx, qy, qz, qw\n"
       "5103.1, 000000, 1, 2, 3, 0, 0, 0, 1\n5103.2, 000001, 2, 2, 3, 0, 0, 0, 1\n"
       "5103.3, 000002, 3, 2, 3, 0, 0, 0, 1\n5103.4, 000003, 4, 2, 3, 0, 0, 0, 1\n"
       "5103.5, 000004, 5, 2, 3, 0, 0, 0, 1\n",
       {1, 2, 3},
       {5, 2, 3},
       true,
       kTenthSteps},
      {"table",  // rostopic echo -p
       "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.pose.position.x,"
       "field.pose.position.y,field.pose.position.z,field.pose.orientation.x,"
       "field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w\n"
       "1500000000100000007,0,1500000000100000000,map,1,2,3,0,0,0,1\n"
       "1500000000200000007,1,1500000000200000000,map,2,2,3,0,0,0,1\n"
       "1500000000300000007,2,1500000000300000000,map,3,2,3,0,0,0,1\n"
       "1500000000400000007,3,1500000000400000000,map,4,2,3,0,0,0,1\n"
       "1500000000500000007,4,1500000000500000000,map,5,2,3,0,0,0,1\n",
       {1, 2, 3},
       {5, 2, 3},
       true,
       kTenthSteps},
      {"table",  // without orientation
       "# timestamp tx ty tz\n1.5 1 2 3\n1.6 2 2 3\n1.7 3 2 3\n1.8 4 2 3\n1.9 5 2 3\n",
       {1, 2, 3},
       {5, 2, 3},
       false,
       kTenthSteps},
      {"table",  // applanix/camera_poses.csv of Boreas
       "GPSTime,easting,northing,altitude,vel_east,vel_north,vel_up,roll,pitch,heading\n"
       "1606417097100000,1,2,3,0,0,0,0,0,1.5\n1606417097200000,2,2,3,0,0,0,0,0,1.5\n"
       "1606417097300000,3,2,3,0,0,0,0,0,1.5\n1606417097400000,4,2,3,0,0,0,0,0,1.5\n"
       "1606417097500000,5,2,3,0,0,0,0,0,1.5\n",
       {1, 2, 3},
       {5, 2, 3},
       true,
       kTenthSteps}};
  return kExamples;
}

std::string refusal(const std::string& text) {
  write_text("p.txt", text);
  return test::error_text([] { read_trajectory("p.txt", {}); });
}

}  // namespace

TEST_CASE("files in the form of their programs are detected and read") {
  for (const Example& example : examples()) {
    INFO(example.layout << ": " << example.text);
    write_text("p.txt", example.text);
    const Layout* layout = open_start("p.txt").layout;
    REQUIRE(layout != nullptr);
    CHECK(layout->name == example.layout);
    CHECK(detect_format("p.txt").name == example.layout);
    const Trajectory found = read_layout("p.txt", *layout, true);
    REQUIRE(found.poses.size() == 5);
    for (size_t k = 0; k < 3; ++k) {
      CHECK(found.poses.front()->position[k] == Approx(example.first[k]).margin(1e-12));
      CHECK(found.poses.back()->position[k] == Approx(example.last[k]).margin(1e-12));
    }
    CHECK(has_heading(*found.poses[0]) == example.has_orientation);
    REQUIRE(found.times_ns.empty() == (example.duration_ns == 0));
    if (!found.times_ns.empty())
      CHECK(found.times_ns.back() - found.times_ns.front() == example.duration_ns);
  }
}

TEST_CASE("lines of words need commas and names of columns") {
  for (const char* text : {"query/a b.jpg ref/a.jpg\n", "0 0\n1 1\n", "query reference\n0 0\n"}) {
    write_text("p.txt", text);
    CHECK(test::has(test::error_text([] { detect_format("p.txt"); }), "Put commas between"));
  }
}

TEST_CASE("each layout has an example") {
  for (const Layout& layout : layouts())
    if (!layout.has("lat") && !layout.has("camera"))  // these have tests of their own
      CHECK(std::ranges::count(examples(), layout.name, &Example::layout) > 0);
}

TEST_CASE("COLMAP's images are cameras of the world, found by name") {
  for (const char* name : {"b 1.jpg", "a.jpg", "c.jpg"}) {
    std::filesystem::create_directories("walk");
    write_text(std::string("walk/") + name, "x");
  }
  // The camera is at (x, 0, 0) and turned by a quarter around z: t = -R c = (0, x, 0) for
  // q = (cos 45, 0, 0, -sin 45).
  const std::string quarter = " 0.70710678 0 0 -0.70710678 0 ";
  write_text("images.txt",
             "# Image list with two lines of data per image:\n"
             "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
             "#   POINTS2D[] as (X, Y, POINT3D_ID)\n# Number of images: 3\n"
             "7" +
                 quarter +
                 "1 0 1 walk/b 1.jpg\n2362.39 248.498 58396 1784.7 268.254 59027\n"
                 "2" +
                 quarter +
                 "9 0 1 walk/a.jpg\n\n"
                 "3" +
                 quarter + "5 0 1 other/z.jpg\n1 2 -1 3 4 -1 5 6 -1 7 8 -1\n");
  GroundTruthArgument argument = by_positions("images.txt", "images.txt", 1);
  check_refused([&] { read_labels(argument, 3, 3); }, "--query-images", ErrorKind::usage);
  const auto names = [] { return std::vector<std::string>{"a.jpg", "b 1.jpg", "c.jpg"}; };
  GroundTruthScope scope{{"", 3}, {{{"ref", 3}, true, names}}};
  scope.query_names = names;
  const GroundTruth truth = read_ground_truth(argument, scope);
  CHECK(test::draw(truth, 3, 3) == "S.i .Si iii");
  CHECK(test::has(truth.protocol, "1 query and 1 training frames without a pose"));
  const Trajectory found = read_layout("images.txt", *find_layout("colmap"), false);
  CHECK(found.poses[0]->position[0] == Approx(1).margin(1e-7));
  CHECK(std::abs(found.poses[0]->position[1]) < 1e-7);
  check_refused([&] { read_trajectory("images.txt", {}); }, "names its frames", ErrorKind::usage);
  // Without lines of points.
  write_text("poses.txt", "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n7" + quarter +
                              "1 0 1 c.jpg\n2" + quarter + "9 0 1 a.jpg\n");
  CHECK(read_layout("poses.txt", *find_layout("colmap"), false).names ==
        std::vector<std::string>{"c.jpg", "a.jpg"});
}

TEST_CASE("a comment above the columns of EuRoC may name another order of the quaternion") {
  const std::string names =
      "#timestamp, p_WS_W_x, p_WS_W_y, p_WS_W_z, q_WS_x, q_WS_y, q_WS_z, q_WS_w\n";
  write_text("okvis.csv", names + "1403636580000000000,1,2,3,0,0,0,1\n");
  const FileStart start = open_start("okvis.csv");
  REQUIRE(start.layout->name == "table");
  const Trajectory found = read_layout("okvis.csv", *start.layout, false);
  CHECK(found.poses[0]->position == std::array<double, 3>{1, 2, 3});
  CHECK(found.poses[0]->orientation == std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1});
}

TEST_CASE("roll, pitch and yaw are the orientation that a quaternion states") {
  write_text("turns.csv", "1326030975726043,1,2,3,0.3,-0.2,1.1\n1326030975826043,1,2,3,0,0,1.1\n");
  write_text("q.txt", "1 1 2 3 0.17835891 -0.00643556 0.52695482 0.83094242\n");  // of SciPy
  const auto read = [](const char* path) {
    return read_layout(path, *open_start(path).layout, false).poses[0].value();
  };
  const Pose turns = read("turns.csv");
  REQUIRE(turns.orientation.has_value());
  for (size_t i = 0; i < 9; ++i)
    CHECK((*turns.orientation)[i] == Approx((*read("q.txt").orientation)[i]).margin(1e-7));
  CHECK_FALSE(turns.heading_deg.has_value());
}

TEST_CASE("GPS of MulRan has degrees after the time") {
  write_text("gps.csv",
             "1561000444390857630,36.38,127.36,70.2,1.96,0,0,0,1.96,0,0,0,7.84\n"
             "1561000444490857630,36.3801,127.36,70.2,1.96,0,0,0,1.96,0,0,0,7.84\n");
  CHECK(detect_format("gps.csv").name == "gps");
  CHECK(read_labels(by_positions("gps.csv", "gps.csv", 11), 2, 2) == "S. .S");
  CHECK(read_labels(by_positions("gps.csv", "gps.csv", 12), 2, 2) == "SS SS");
}

TEST_CASE("a trajectory of TUM is compared with one of EuRoC") {
  write_text("slam.txt", "1403636580.0 0 0 0 0 0 0 1\n1403636580.1 8 0 0 0 0 0 1\n");
  write_text("truth.csv",
             "1403636580000000000,0,0,0,1,0,0,0\n1403636580050000000,4,0,0,1,0,0,0\n"
             "1403636580100000000,8,0,0,1,0,0,0\n");
  const GroundTruthArgument argument = by_positions("slam.txt", "truth.csv", 4);
  CHECK(read_labels(argument, 2, 3) == "SS. .SS");
  CHECK(read_ground_truth(argument, {{"", 2}, {{"ref", 3}}}).protocol.find("tum and euroc poses") ==
        0);
  write_text("gps.csv", "lat,lon\n52,13\n");
  check_refused([&] { read_labels(by_positions("slam.txt", "gps.csv", 4), 2, 1); },
                "has the format gps, and slam.txt has tum");
}

TEST_CASE("columns with implausible values are refused") {
  CHECK(test::has(refusal("1326030975726043,1,2,3,0.1,9.81,0.3\n"), "radians are at most 6.28"));
  CHECK(test::has(refusal("source_timestamp,destination_timestamp,x,y,z,roll,pitch,yaw\n"
                          "2,1,0.1,0,0,0,0,0\n"),
                  "motions between two times"));
  // Roll, pitch and yaw in the columns of a quaternion.
  CHECK(test::has(refusal("1 0 0 0 0.01 0.02 0.3 0\n2 1 0 0 0.01 0.02 0.3 0\n"),
                  "line 1: its quaternion has the length 0.30083"));
  CHECK(test::has(refusal("1 0 0 0 0 0 1.5 0\n2 1 0 0 0 0 1.5 0\n3 1 0 0 0 0 0 1\n"),
                  "2 of its 3 quaternions have another length than 1"));
  CHECK(refusal("1 0 0 0 0 0 0 2\n2 1 0 0 0 0 0 1\n").empty());
  // A matrix, and a header that contradicts the columns.
  CHECK(test::has(refusal("1561000444000000000,200,-1,0,3,1,0,0,4,0,0,1,20\n"), "not a rotation"));
  CHECK(test::has(refusal("# kapture format: 1.1\n0, c, 0, 0, 0, 1, 0, 0, 5\n"
                          "1, c, 0, 0, 1, 0, 0, 0, -5\n"),
                  "map the world to the camera"));
  CHECK(test::has(refusal("# kapture format: 1.1\n0, a, 1, 0, 0, 0, 0, 0, 0\n"
                          "0, b, 1, 0, 0, 0, 0, 0, 1\n1, a, 1, 0, 0, 0, 1, 0, 0\n"),
                  "line 3: is a pose of the device b, earlier lines are of a"));
  CHECK(test::has(refusal("# kapture format: 1.1\n# timestamp, device_id, x, y, z, utc, dop\n"
                          "0, gps, 16.9, 52.4, 80, 1600000000, 1\n"),
                  "x and y are degrees"));
  CHECK(test::has(refusal("sec,pos_x,pos_y,pos_z,x,y,z,w\n0.1,1,2,3,0,0,0,1\n"),
                  "x, y, z and w are a quaternion"));
  write_text("p.csv", "#sec,nsec,x,y,z,qx,qy,qz,qw\n1583836591,100000000,1,2,3,0,0,0,1\n");
  GroundTruthArgument argument = by_positions("p.csv", "p.csv", 1);
  argument.format = "euroc";
  check_refused([&] { read_labels(argument, 1, 1); }, "has 9 columns, but euroc");
  write_text("rtabmap.txt", "#timestamp x y z qx qy qz qw id\n1583836591.1 1 2 3 0 0 0 1 1\n");
  argument = by_positions("rtabmap.txt", "rtabmap.txt", 1);
  argument.format = "tum";
  check_refused([&] { read_labels(argument, 1, 1); }, "Its layout is rtabmap");
}

TEST_CASE("numbered vertices and frames have gaps, and keys of GTSAM count in their low bytes") {
  write_text("g.g2o",
             "VERTEX_SE3:QUAT 8646911284551352320 0 0 0 0 0 0 1\n"
             "VERTEX_SE3:QUAT 8646911284551352322 9 0 0 0 0 0 1\n");
  CHECK(read_labels(by_positions("g.g2o", "g.g2o", 1), 3, 4) == "Si.i iiii .iSi");
  write_text("g.g2o", "VERTEX_SE2 1 0 0 0\nVERTEX_SE2 1 0 0 0\n");
  check_refused([&] { read_labels(by_positions("g.g2o", "g.g2o", 1), 2, 2); },
                "line 2: frame 1 is listed twice");
}

TEST_CASE("poses that are far from each other cause a warning") {
  test::Warnings warnings;
  write_text("p.txt", "1 500000 4000000 0 0 0 0 1\n2 0 0 0 0 0 0 1\n3 500001 4000000 0 0 0 0 1\n");
  warn_of_steps(read_trajectory("p.txt", {}), warnings.monitor);
  REQUIRE(warnings.said.size() == 1);
  CHECK(test::has(
      warnings.said[0],
      "p.txt: 2 steps between poses are longer than 1000 m, such as 4031129 m from pose 0 "
      "to pose 1"));
  write_text("p.txt",
             "1 500000 4000000 0 0 0 0 1\n2 nan nan 0 0 0 0 1\n3 500999 4000000 0 0 0 0 1\n");
  warn_of_steps(read_trajectory("p.txt", {}), warnings.monitor);
  CHECK(warnings.said.size() == 1);
}
