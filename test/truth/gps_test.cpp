// Ground truth by latitude and longitude.
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "truth/frame_times.h"
#include "truth/positions.h"
#include "truth/times.h"
#include "truth/truth_files.h"

using namespace vpr;
using test::by_positions;
using test::check_refused;
using test::read_labels;
using test::write_text;

// 0.0001 degrees are 11.13 m of latitude and 6.87 m of longitude there.
TEST_CASE("fixes of frames are compared in meters") {
  write_text("q.csv", "frame,lat,lon\n0,52,13\n2,52.0001,13\n");
  write_text("r.csv", "\"Longitude\",frame,\"Latitude\"\n13.0001,0,52\n13,1,52.0001\n13,2,-52\n");
  CHECK(read_labels(by_positions("q.csv", "r.csv", 12), 4, 3) == "SS. iii .S. iii");
  CHECK(read_labels(by_positions("q.csv", "r.csv", 11), 4, 3) == "S.. iii .S. iii");
  CHECK(read_labels(by_positions("q.csv", "r.csv", 6.86), 4, 3) == "... iii .S. iii");
  write_text("m.csv", "frame,x,y\n0,0,0\n1,0,0\n2,0,0\n");
  check_refused([&] { read_labels(by_positions("q.csv", "m.csv", 1), 3, 3); }, "in meters");
  check_refused([&] { read_labels(by_positions("m.csv", "r.csv", 1), 3, 3); }, "format gps");
}

TEST_CASE("fixes on both sides of the antimeridian are near each other") {
  write_text("q.csv", "latitude,longitude\n0,179.99999\n0,-0.5\n");
  write_text("r.csv", "latitude,longitude\n0,-179.99999\n0,359.5\n");
  CHECK(read_labels(by_positions("q.csv", "r.csv", 3), 2, 2) == "S. .S");
}

TEST_CASE("with fixes by image names, other images have no place") {
  for (const char* image : {"a1.jpg", "a2.jpg", "a10.jpg"}) {
    std::filesystem::create_directories("walk");
    write_text(std::string("walk/") + image, "x");
  }
  write_text("q.csv", "image,lat,lng,heading\nwalk/a10,52,13,90\na1.jpg,52.001,13,0\n");
  write_text("r.csv", "lat,lon,heading\n52.001,13,10\n52,13,270\n,,\n");
  GroundTruthArgument argument = by_positions("q.csv", "r.csv", 2);
  check_refused([&] { read_labels(argument, 3, 3); }, "--query-images", ErrorKind::usage);
  argument.options.query.images = "walk";
  CHECK(read_labels(argument, 3, 3) == "S.i iii .Si");
  argument.options.angle_deg = 20;
  CHECK(read_labels(argument, 3, 3) == "S.i iii ..i");
  write_text("q.csv", "image,lat,lon\na3.jpg,52,13\n");
  check_refused([&] { read_labels(argument, 3, 3); }, "line 2");
  write_text("q.csv", "image,lat,lon\na1.jpg,52,13\nb/a1.jpg,52,13\n");
  check_refused([&] { read_labels(argument, 3, 3); }, "line 3: the image b/a1.jpg is listed twice");
}

TEST_CASE("names of frames in any column identify them, if the names of the sequence are known") {
  const auto names = [] { return std::vector<std::string>{"walk/b.jpg", "walk/c.jpg"}; };
  GroundTruthScope scope{{"", 2}, {{{"ref", 2}, true, names}}};
  GroundTruthScope unknown = scope;
  scope.query_names = names;
  write_text("r.csv", "lat,lon\n52,13\n53,13\n");
  const auto draw = [&](const std::string& rows, const GroundTruthScope& by) {
    write_text("q.csv", rows);
    return test::draw(read_ground_truth(by_positions("q.csv", "r.csv", 1), by), 2, 2);
  };
  for (const char* rows : {",key,lon,lat,ca\n0,c,13,53,1\n1,b,13,52,1\n",
                           "image_name,lat,lon\nc.jpg,53,13\nb.jpg,52,13\n",
                           "image,time,lat,lon\nc,1,53,13\nb,2,52,13\nz,3,1,1\n",
                           "note,shot,lat,lon\nx,walk/c,53,13\nx,walk/b,52,13\n"}) {
    INFO(rows);
    CHECK(draw(rows, scope) == "S. .S");
  }
  CHECK(draw("note,lat,lon\nfirst,52,13\nsecond,53,13\n", scope) == "S. .S");
  check_refused([&] { draw("key,lat,lon\nx,52,13\ny,53,13\n", scope); },
                "no line names a frame of the sequence; the first names x");
  check_refused([&] { draw("shot,lat,lon\nc.jpg,52,13\nb.jpg,53,13\n", unknown); },
                "--query-images", ErrorKind::usage);
}

TEST_CASE("logs of phones and of ROS are read by their own columns") {
  write_text("r.csv", "lat,lon\n52,13\n52.001,13\n");
  for (const char* rows :
       {"\"Time (s)\",\"Latitude (\xc2\xb0)\",\"Longitude (\xc2\xb0)\",\"Height (m)\",\"Velocity "
        "(m/s)\"\n"
        "0.5,52,13,40,1\n1.5,52.001,13,40,1\n",
        "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.latitude,"
        "field.longitude,field.altitude\n1500000000000000000,1,1500000000000000000,gps,52,13,9\n"
        "1500000001000000000,2,1500000001000000000,gps,52.001,13,9\n"}) {
    write_text("q.csv", rows);
    GroundTruthArgument argument = by_positions("q.csv", "r.csv", 1);
    CHECK(read_labels(argument, 2, 2) == "S. .S");
    const auto times = read_fixes("q.csv").times_ns;
    REQUIRE(times.size() == 2);
    CHECK(times[1] - times[0] == kSecond);
  }
}

TEST_CASE("latitudes and longitudes in radians are refused, unless the header names their unit") {
  const std::string radians = "0.9076,0.2269\n0.9077,0.2269\n";
  write_text("q.csv", "lat,lon\n" + radians);
  check_refused([&] { read_labels(by_positions("q.csv", "q.csv", 1), 2, 2); },
                "lat_rad and lon_rad");
  check_refused([&] { read_trajectory("q.csv", {}); }, "lat_rad and lon_rad");
  write_text("q.csv", "lat_rad,lon_rad\n" + radians);
  // 0.0001 radians are 638 m of latitude.
  CHECK(read_labels(by_positions("q.csv", "q.csv", 639), 2, 2) == "SS SS");
  CHECK(read_labels(by_positions("q.csv", "q.csv", 637), 2, 2) == "S. .S");
  write_text("q.csv", "lat_deg,lon_deg\n" + radians);
  CHECK(read_labels(by_positions("q.csv", "q.csv", 12), 2, 2) == "SS SS");
}

TEST_CASE("invalid positions are refused with the line") {
  write_text("r.csv", "lat,lon\n52,13\n");
  const auto refused = [&](const std::string& rows, const std::string& words) {
    write_text("q.csv", "lat,lon\n" + rows);
    check_refused([&] { read_labels(by_positions("q.csv", "r.csv", 1), 2, 1); }, words);
  };
  refused("52,13\n103.8,1.3\n",
          "line 3: the latitude 103.8 is beyond 90 degrees; are latitude and");
  refused("52,13\n103.8,100\n", "line 3: the latitude 103.8 is beyond 90 degrees");
  refused("52,361\n", "line 2: the longitude 361 is not within");
  refused("nan,13\n", "line 2: the latitude \"nan\" is not a number");
  refused("52,\n", "line 2: the longitude \"\" is not a number");
  refused(",\n,\n", "no fix for any frame");
}

TEST_CASE("a side without fixes for most frames causes a warning") {
  write_text("q.csv", "lat,lon\n52,13\n,\n,\n");
  write_text("r.csv", "lat,lon\n52,13\n60,13\n61,13\n62,13\n");
  GroundTruthArgument argument = by_positions("q.csv", "r.csv", 1);
  test::Warnings warnings;
  read_ground_truth(argument, {{"", 3}, {{"ref", 4}}}, warnings.monitor);
  REQUIRE_FALSE(warnings.said.empty());
  CHECK(test::has(warnings.said.front(), "2 of 3 frames have no fix"));
}

TEST_CASE("frames are located on a track by time") {
  write_text("t.csv",
             "time,lat,lon\n2024-05-01T12:00:00Z,52,13\n2024-05-01T12:00:02Z,52.0002,13\n");
  // At the first fix, halfway between the two, and long after.
  write_text("q.times", "1714564800\n1714564801\n1714564900\n");
  write_text("r.csv",
             "lat,lon,time\n52.0001,13,2024-05-01T12:00:01Z\n52,13,2024-05-01T12:00:05Z\n");
  GroundTruthArgument argument = by_positions("t.csv", "r.csv", 1);
  argument.options.query.times = "q.times";
  CHECK(read_labels(argument, 3, 2) == ".S S. ii");
  GroundTruthOptions train;
  train.train.times = "q.times";
  CHECK(read_train_poses("t.csv", train, {}, {}).poses[1].has_value());
  argument.options.max_difference_s = 0.5;
  CHECK(read_labels(argument, 3, 2) == ".S ii ii");
  argument.options.query.times.clear();
  argument.options.max_difference_s.reset();
  CHECK(read_labels(argument, 2, 2) == ".S ..");
  check_refused([&] { read_labels(argument, 3, 2); }, "with --query-times");
  check_refused([&] { read_labels(argument, 2, 3); }, "with --train-times");
}

TEST_CASE("times of fixes that decrease, repeat or are missing are refused") {
  write_text("r.csv", "lat,lon\n52,13\n");
  write_text("q.times", "1714564800\n");
  const auto refused = [&](const std::string& rows, const std::string& words) {
    write_text("t.csv", "time,lat,lon\n" + rows);
    GroundTruthArgument argument = by_positions("t.csv", "r.csv", 1);
    argument.options.query.times = "q.times";
    check_refused([&] { read_labels(argument, 1, 1); }, words);
  };
  refused("2024-05-01T12:00:02Z,52,13\n2024-05-01T12:00:02Z,52,13\n",
          "t.csv, line 3: its time 1714564802 equals the time of the previous frame");
  refused("2024-05-01T12:00:02Z,52,13\n2024-05-01T12:00:01Z,52,13\n",
          "is before the time of the previous frame");
  refused("2024-05-01T12:00:02Z,52,13\n,52,13\n", "line 3: \"\" is not a valid time");
  refused("noon,52,13\n", "line 2: \"noon\" is not a valid time");
}

TEST_CASE("formats that scripts convert are refused with the script") {
  write_text("r.csv", "lat,lon\n52,13\n");
  write_text("t.gpx", "<?xml version=\"1.0\"?>\n<gpx><trk/></gpx>\n");
  std::filesystem::create_directories("photos");
  write_text("photos/IMG_1.jpg", "\xff\xd8\xff");
  const auto refused = [&](const std::string& query, const std::string& script, ErrorKind kind) {
    GroundTruthArgument argument = by_positions(query, "r.csv", 1);
    check_refused([&] { read_labels(argument, 1, 1); }, "scripts/convert/" + script, kind);
    std::swap(argument.path, argument.options.reference);
    check_refused([&] { read_labels(argument, 1, 1); }, "scripts/convert/" + script,
                  ErrorKind::usage);
  };
  refused("t.gpx", "gpx.py", ErrorKind::usage);
  write_text("t.nmea", "$GPGGA,120000.00,5200.0000,N,01300.0000,E,1,08,0.9,40.0,M,45.0,M,,*6B\r\n");
  refused("t.nmea", "gpx.py", ErrorKind::usage);
  check_refused([&] { read_trajectory("t.nmea", {}); },
                "gpsbabel -i nmea -f LOG -o gpx -F track.gpx, then", ErrorKind::usage);
  write_text("t.log", "\n$PMTK011,MTKGPS*08\n$GPRMC,120000,A,5200.0,N,01300.0,E,0,0,010524,,*00\n");
  check_refused([&] { read_trajectory("t.log", {}); }, "-i nmea", ErrorKind::usage);
  write_text("t.kml", "<?xml version=\"1.0\"?>\n<kml></kml>\n");
  check_refused([&] { read_trajectory("t.kml", {}); }, "-i kml", ErrorKind::usage);
  write_text("t.tcx", "<?xml version=\"1.0\"?>\n<TrainingCenterDatabase/>\n");
  check_refused([&] { read_trajectory("t.tcx", {}); }, "-i gtrnctr", ErrorKind::usage);
  refused("photos", "exif.py", ErrorKind::data);
  check_refused([&] { read_trajectory("t.gpx", {}); }, "gpx.py", ErrorKind::usage);
  check_refused([&] { read_frame_times("photos", {}, {}); }, "exif.py");
}

TEST_CASE("trajectories and maps of fixes are projected to a plane at the first fix") {
  write_text("t.csv", "lat,lon\n52,13\n52.001,13\n");
  const Trajectory found = read_trajectory("t.csv", {});
  CHECK(found.poses[0]->position == std::array<double, 3>{});
  CHECK(found.poses[1]->position[1] == Approx(111.267).margin(0.01));
  CHECK(std::abs(found.poses[1]->position[0]) < 1e-9);
  write_text("a.csv", "frame,lat,lon\n1,52,13\n");
  write_text("b.csv", "frame,lat,lon\n0,52.001,13\n");
  write_text("m.csv", "frame,x,y\n0,1,2\n");
  const auto path = [&](const char* name) { return name; };
  const Routes routes = read_routes({path("a.csv"), path("b.csv")});
  CHECK(routes.is_gps);
  CHECK_FALSE(routes.routes[0][0]);
  CHECK(routes.routes[0][1]->x == 0);
  CHECK(routes.routes[1][0]->y == Approx(111.267).margin(0.01));
  CHECK_FALSE(read_routes({path("m.csv")}).is_gps);
  check_refused(
      [&] {
        read_routes({path("a.csv"), path("m.csv")});
      },
      "m.csv has x and y in meters");
}
