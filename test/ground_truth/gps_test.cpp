// Ground truth by latitude and longitude: CSV, GPX tracks, and EXIF tags of images.
#include "ground_truth/gps.h"

#include <cmath>
#include <functional>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/error.h"
#include "ground_truth/exif.h"
#include "ground_truth/exif_bytes.h"
#include "ground_truth/frame_times.h"
#include "ground_truth/gpx.h"
#include "ground_truth/route.h"
#include "ground_truth/truth_files.h"

using namespace vpr;
using test::Files;

namespace {

/// 0.0001 degrees of latitude are 11.13 m there, of longitude 6.87 m.
GroundTruthArgument fixes(const std::string& query, const std::string& reference, double radius) {
  GroundTruthArgument argument{"", query};
  argument.options.reference = reference;
  argument.options.radius_m = radius;
  return argument;
}

void check_refused(const std::function<void()>& work, const std::string& words,
                   ErrorKind kind = ErrorKind::data) {
  CHECK(test::error_kind(work) == kind);
  const std::string text = test::error_text(work);
  INFO(text);
  CHECK(text.find(words) != std::string::npos);
}

std::string track(const std::string& points) {
  return "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" "
         "xmlns=\"http://www.topografix.com/GPX/1/1\">\n<wpt lat=\"1\" "
         "lon=\"1\"/>\n<trk><trkseg>\n" +
         points + "</trkseg></trk></gpx>\n";
}

std::string point(double latitude, const std::string& time = "") {
  return fmt::format("<trkpt lat=\"{}\" lon=\"13\"><ele>34</ele>{}</trkpt>\n", latitude,
                     time.empty() ? "" : "<time>" + time + "</time>");
}

/// Of an image at 52 degrees, 0 minutes and so many hundredths of seconds north, and 13 east.
test::ExifFields at_52_north(uint32_t hundredths) {
  test::ExifFields fields;
  fields.latitude = {{{52, 1}, {0, 1}, {hundredths, 100}}};
  fields.longitude = {{{13, 1}, {0, 1}, {0, 1}}};
  return fields;
}

}  // namespace

TEST_CASE("fixes of frames, of either side, are compared in metres") {
  const Files files;
  files.text("q.csv", "frame,lat,lon\n0,52,13\n2,52.0001,13\n");
  files.text("r.csv", "\"Longitude\",frame,\"Latitude\"\n13.0001,0,52\n13,1,52.0001\n13,2,-52\n");
  CHECK(files.read(fixes("q.csv", "r.csv", 12), 4, 3) == "SS. iii .S. iii");
  CHECK(files.read(fixes("q.csv", "r.csv", 11), 4, 3) == "S.. iii .S. iii");
  CHECK(files.read(fixes("q.csv", "r.csv", 6.86), 4, 3) == "... iii .S. iii");
  files.text("m.csv", "frame,x,y\n0,0,0\n1,0,0\n2,0,0\n");
  check_refused([&] { files.read(fixes("q.csv", "m.csv", 1), 3, 3); }, "in metres");
  check_refused([&] { files.read(fixes("m.csv", "r.csv", 1), 3, 3); }, "format gps");
}

TEST_CASE("fixes across the antimeridian are near each other") {
  const Files files;
  files.text("q.csv", "latitude,longitude\n0,179.99999\n0,-0.5\n");
  files.text("r.csv", "latitude,longitude\n0,-179.99999\n0,359.5\n");
  CHECK(files.read(fixes("q.csv", "r.csv", 3), 2, 2) == "S. .S");
}

TEST_CASE("fixes by the names of images leave others without a place") {
  const Files files;
  for (const char* image : {"a1.jpg", "a2.jpg", "a10.jpg"}) {
    std::filesystem::create_directories(files.folder / "walk");
    files.text(std::string("walk/") + image, "x");
  }
  files.text("q.csv", "image,lat,lng,heading\nwalk/a10.jpg,52,13,90\na1.jpg,52.001,13,0\n");
  files.text("r.csv", "lat,lon,heading\n52.001,13,10\n52,13,270\n,,\n");
  GroundTruthArgument argument = fixes("q.csv", "r.csv", 2);
  check_refused([&] { files.read(argument, 3, 3); }, "--query-images", ErrorKind::usage);
  argument.options.query_images = files.folder / "walk";
  CHECK(files.read(argument, 3, 3) == "S.i iii .Si");
  argument.options.angle_deg = 20;
  CHECK(files.read(argument, 3, 3) == "S.i iii ..i");
  files.text("q.csv", "image,lat,lon\na3.jpg,52,13\n");
  check_refused([&] { files.read(argument, 3, 3); }, "line 2");
  files.text("q.csv", "image,lat,lon\na1.jpg,52,13\nb/a1.jpg,52,13\n");
  check_refused([&] { files.read(argument, 3, 3); }, "line 3: the image a1.jpg is given twice");
}

TEST_CASE("places that are none are refused with their line") {
  const Files files;
  files.text("r.csv", "lat,lon\n52,13\n");
  const auto refused = [&](const std::string& rows, const std::string& words) {
    files.text("q.csv", "lat,lon\n" + rows);
    check_refused([&] { files.read(fixes("q.csv", "r.csv", 1), 2, 1); }, words);
  };
  refused("52,13\n103.8,1.3\n",
          "line 3: the latitude 103.8 is beyond 90 degrees; are latitude and");
  refused("52,13\n103.8,100\n", "line 3: the latitude 103.8 is beyond 90 degrees");
  refused("52,361\n", "line 2: the longitude 361 is not within");
  refused("nan,13\n", "line 2: the latitude \"nan\" is not a number");
  refused("52,\n", "line 2: the longitude \"\" is not a number");
  refused(",\n,\n", "no fix of any frame");
}

TEST_CASE("a side of which most frames have no fix is warned of") {
  const Files files;
  files.text("q.csv", "lat,lon\n52,13\n,\n,\n");
  files.text("r.csv", "lat,lon\n52,13\n60,13\n61,13\n62,13\n");
  GroundTruthArgument argument = fixes(files.folder / "q.csv", files.folder / "r.csv", 1);
  std::vector<std::string> warnings;
  Monitor monitor;
  monitor.warn = [&](const std::string& sentence) { warnings.push_back(sentence); };
  read_ground_truth(argument, {3, {{"ref", 4}}}, monitor);
  REQUIRE_FALSE(warnings.empty());
  CHECK(warnings.front().find("2 of 3 frames have no fix") != std::string::npos);
}

TEST_CASE("tracks are read through all their segments, with times in UTC") {
  const Files files;
  files.text("t.gpx", track(point(52, "2024-05-01T12:00:00Z") + "</trkseg><trkseg>" +
                            point(53, " 2024-05-01T14:00:01.5+02:00\n") + "</trkseg></trk><trk>" +
                            "<trkseg>" + point(54, "2024-05-01T12:00:03Z")));
  const Trajectory found = read_gpx(files.folder / "t.gpx");
  REQUIRE(found.poses.size() == 3);
  CHECK(found.times_ns[1] - found.times_ns[0] == 1500000000);
  CHECK(found.times_ns[0] == 1714564800000000000);
  CHECK(found.lines == std::vector<size_t>{5, 6, 8});
  CHECK(found.poses[1]->position == earth_position({53, 13}));
  CHECK(read_gpx((files.folder / "t.gpx").string() + "@1:2").times_ns.size() == 1);
}

TEST_CASE("frames find their place on a track by their times") {
  const Files files;
  files.text("t.gpx",
             track(point(52, "2024-05-01T12:00:00Z") + point(52.0002, "2024-05-01T12:00:02Z")));
  // At the first fix, half way between the two, and long after.
  files.text("q.times", "1714564800\n1714564801\n1714564900\n");
  files.text("r.csv",
             "lat,lon,time\n52.0001,13,2024-05-01T12:00:01Z\n52,13,2024-05-01T12:00:05Z\n");
  GroundTruthArgument argument = fixes("t.gpx", "r.csv", 1);
  argument.options.query_times = files.folder / "q.times";
  CHECK(files.read(argument, 3, 2) == ".S S. ii");
  argument.options.max_difference_s = 0.5;
  CHECK(files.read(argument, 3, 2) == ".S ii ii");
  argument.options.query_times.clear();
  argument.options.max_difference_s.reset();
  CHECK(files.read(argument, 2, 2) == ".S ..");
}

TEST_CASE("times of fixes that fall, repeat or miss are refused") {
  const Files files;
  files.text("r.csv", "lat,lon\n52,13\n");
  files.text("q.times", "1714564800\n");
  const auto refused = [&](const std::string& points, const std::string& words) {
    files.text("t.gpx", track(points));
    GroundTruthArgument argument = fixes("t.gpx", "r.csv", 1);
    argument.options.query_times = files.folder / "q.times";
    check_refused(
        [&] { files.read(argument, 1, 1); }, words,
        words.find("has no times") == std::string::npos ? ErrorKind::data : ErrorKind::usage);
  };
  refused(point(52, "2024-05-01T12:00:02Z") + point(52, "2024-05-01T12:00:02Z"),
          "t.gpx, line 6: its time 1714564802 is that of the frame before");
  refused(point(52, "2024-05-01T12:00:02Z") + point(52, "2024-05-01T12:00:01Z"),
          "is before that of the frame before");
  refused(point(52, "2024-05-01T12:00:02Z") + point(52),
          "line 6: the track point has no time, and those before have");
  refused(point(52) + point(52, "2024-05-01T12:00:02Z"), "line 6: the track points before");
  refused(point(52, "noon"), "line 5: \"noon\" is no time");
  refused(point(52), "has no times");
  refused(point(92), "line 5: the latitude 92 is beyond");
  refused("<trkpt lat=\"52\"/>", "line 5: the longitude \"\" is not a number");
  refused("", "has no track points");
}

TEST_CASE("damaged XML and XML with entities is refused") {
  const Files files;
  const auto refused = [&](const std::string& text, const std::string& words) {
    files.text("t.gpx", text);
    check_refused([&] { read_gpx(files.folder / "t.gpx"); }, words);
  };
  const std::string good = track(point(52) + point(53));
  for (size_t size = 0; size < good.size() - 1; ++size) {
    files.text("t.gpx", good.substr(0, size));
    CHECK(test::error_kind([&] { read_gpx(files.folder / "t.gpx"); }) == ErrorKind::data);
  }
  refused(good.substr(0, good.size() - 22), "incomplete");
  refused("<gpx><trk></gpx>", "line 1: is damaged XML: mismatched tag");
  refused("<kml/>", "is no GPX, but <kml>");
  const std::string bomb =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE gpx [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;&a;\">]>\n"
      "<gpx><trk><trkseg><trkpt lat=\"1\" lon=\"1\"><time>&b;</time></trkpt></trkseg></trk></gpx>";
  refused(bomb, "line 2: has a document type");
  refused("<!DOCTYPE gpx SYSTEM \"secret\"><gpx/>", "has a document type");
}

TEST_CASE("images say where and when they were taken") {
  test::ExifFields fields = at_52_north(1234);
  fields.latitude_ref = "S";
  fields.longitude_ref = "W";
  fields.taken = "2024:05:01 14:00:00";
  fields.fraction = "25";
  ImageTags tags = read_exif(test::jpeg_with_exif(fields), {"a.jpg"});
  REQUIRE(tags.place);
  CHECK(tags.place->latitude_deg == Approx(-(52 + 12.34 / 3600)).margin(1e-12));
  CHECK(tags.place->longitude_deg == -13);
  REQUIRE(tags.taken);
  CHECK(tags.taken->ns == 1714572000250000000);
  CHECK_FALSE(tags.taken->has_zone);
  fields.zone = "+02:00";
  tags = read_exif(test::jpeg_with_exif(fields), {"a.jpg"});
  CHECK(tags.taken->ns == 1714564800250000000);
  CHECK(tags.taken->has_zone);
  fields.status = "V";  // the receiver says that it is void
  CHECK_FALSE(read_exif(test::jpeg_with_exif(fields), {"a.jpg"}).place);
}

TEST_CASE("positions of images that are none are no place, and impossible ones are refused") {
  test::ExifFields fields = at_52_north(0);
  fields.latitude[2] = {0, 0};
  CHECK_FALSE(read_exif(test::jpeg_with_exif(fields), {"a.jpg"}).place);
  fields.latitude = fields.longitude = {{{0, 1}, {0, 1}, {0, 1}}};
  CHECK_FALSE(read_exif(test::jpeg_with_exif(fields), {"a.jpg"}).place);
  fields.has_place = false;
  CHECK_FALSE(read_exif(test::jpeg_with_exif(fields), {"a.jpg"}).place);
  CHECK_FALSE(read_exif("", {"a.jpg"}).place);
  CHECK_FALSE(read_exif("\xff\xd8\xff\xd9", {"a.jpg"}).taken);
  fields = at_52_north(0);
  fields.latitude[0] = {95, 1};
  check_refused([&] { read_exif(test::jpeg_with_exif(fields), {"a.jpg"}); },
                "a.jpg: its GPS position, 95 and 13 degrees, is not on the globe");
  fields = at_52_north(0);
  fields.longitude_ref.clear();
  check_refused([&] { read_exif(test::jpeg_with_exif(fields), {"a.jpg"}); }, "E or W");
  const std::string whole = test::jpeg_with_exif(at_52_north(0));
  for (size_t size = 0; size < whole.size(); ++size)
    test::error_kind([&] { read_exif(whole.substr(0, size), {"a.jpg"}); });
}

TEST_CASE("a folder of images with positions is a ground truth, and their times are times") {
  const Files files;
  const auto image = [&](const std::string& name, uint32_t hundredths, const std::string& taken) {
    std::filesystem::create_directories((files.folder / name).parent_path());
    test::ExifFields fields = at_52_north(hundredths);
    fields.taken = taken;
    fields.has_place = hundredths < 1000;
    files.text(name, test::jpeg_with_exif(fields));
  };
  image("q/IMG_1.jpg", 0, "2024:05:01 12:00:00");
  image("q/IMG_2.jpg", 9999, "2024:05:01 12:00:02");  // without a place
  image("q/IMG_3.jpg", 20, "2024:05:01 12:00:03");    // 0.2 seconds: 6.2 m
  files.text("r.csv", "lat,lon\n52,13\n52.0000555,13\n");
  CHECK(files.read(fixes("q", "r.csv", 1), 3, 2) == "S. ii .S");
  std::vector<std::string> warnings;
  Monitor monitor;
  monitor.warn = [&](const std::string& sentence) { warnings.push_back(sentence); };
  CHECK(read_frame_times(files.folder / "q", monitor) ==
        std::vector<int64_t>{1714564800000000000, 1714564802000000000, 1714564803000000000});
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("--offset -7200") != std::string::npos);
  image("q/IMG_4.jpg", 20, "2024:05:01 12:00:03");
  check_refused([&] { read_frame_times(files.folder / "q", {}); },
                "IMG_4.jpg: its time 1714564803 is that of the frame before");
  image("none/IMG_1.jpg", 5000, "");
  check_refused([&] { files.read(fixes("none", "r.csv", 1), 1, 2); },
                "IMG_1.jpg: has no GPS position in its EXIF tags");
  check_refused([&] { read_frame_times(files.folder / "none", {}); }, "is no time");
}

TEST_CASE("trajectories and maps of fixes lie on a plane at the first") {
  const Files files;
  files.text("t.gpx", track(point(52) + point(52.001)));
  const Trajectory found = read_trajectory(files.folder / "t.gpx", {});
  CHECK(found.poses[0]->position == std::array<double, 3>{});
  CHECK(found.poses[1]->position[1] == Approx(111.267).margin(0.01));
  CHECK(std::abs(found.poses[1]->position[0]) < 1e-9);
  files.text("a.csv", "frame,lat,lon\n1,52,13\n");
  files.text("b.csv", "frame,lat,lon\n0,52.001,13\n");
  files.text("m.csv", "frame,x,y\n0,1,2\n");
  const auto path = [&](const char* name) { return files.folder / name; };
  const Routes routes = read_routes({path("a.csv"), "", path("b.csv")});
  CHECK(routes.is_gps);
  CHECK_FALSE(routes.routes[0][0]);
  CHECK(routes.routes[0][1]->x == 0);
  CHECK(routes.routes[1].empty());
  CHECK(routes.routes[2][0]->y == Approx(111.267).margin(0.01));
  CHECK_FALSE(read_routes({path("m.csv")}).is_gps);
  check_refused([&] { read_routes({path("a.csv"), path("m.csv")}); }, "m.csv x and y in metres");
}
