// Positions on the ellipsoid against published values, dates, and positions for maps.
#include "truth/positions.h"

#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "support.h"
#include "truth/times.h"

using namespace vpr;

namespace {

double length_between(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  double square = 0;
  for (size_t k = 0; k < 3; ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(square);
}

double meters_apart(const Geographic& a, const Geographic& b) {
  return length_between(earth_position(a), earth_position(b));
}

template <class Read>
std::optional<ErrorKind> kind_of(const std::string& text, Read read) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "f.csv", text);
  return test::error_kind([&] { read(folder / "f.csv"); });
}

}  // namespace

TEST_CASE("positions on the earth equal those of WGS84") {
  CHECK(length_between(earth_position({0, 0}), {6378137, 0, 0}) < 1e-8);
  CHECK(length_between(earth_position({90, 17}), {0, 0, 6356752.314245}) < 1e-6);
  CHECK(length_between(earth_position({45, 0}), {4517590.8788, 0, 4487348.4088}) < 1e-3);
  CHECK(length_between(earth_position({-45, 90}), {0, 4517590.8788, -4487348.4088}) < 1e-3);
}

TEST_CASE("distances equal geodesic ones, except for the curvature of the earth") {
  // Flinders Peak to Buninyong, the worked example of Geoscience Australia: 54 972.271 m along the
  // ellipsoid; the straight line is d^3 / (24 R^2) = 0.17 m shorter.
  const Geographic flinders{-(37 + 57 / 60.0 + 3.72030 / 3600), 144 + 25 / 60.0 + 29.52440 / 3600};
  const Geographic buninyong{-(37 + 39 / 60.0 + 10.15610 / 3600),
                             143 + 55 / 60.0 + 35.38390 / 3600};
  CHECK(meters_apart(flinders, buninyong) == Approx(54972.271 - 0.170).margin(0.005));
  // At the equator, a degree of longitude is 111 319.4908 m and a degree of latitude 110 574.27 m;
  // at the poles it is 111 693.9 m. The test uses a hundred thousandth of them.
  CHECK(meters_apart({0, 10}, {0, 10.00001}) == Approx(1.113194908).margin(1e-6));
  CHECK(meters_apart({-0.000005, 10}, {0.000005, 10}) == Approx(1.1057427).margin(1e-5));
  CHECK(meters_apart({90, 0}, {89.99999, 0}) == Approx(1.116939).margin(1e-5));
}

TEST_CASE("UTM coordinates are places on the ellipsoid") {
  // By pyproj 3.4.1, EPSG 32633, 32632 and 32756.
  const auto is_near = [](const Geographic& found, double latitude, double longitude) {
    CHECK(found.latitude_deg == Approx(latitude).margin(1e-9));
    CHECK(found.longitude_deg == Approx(longitude).margin(1e-9));
  };
  is_near(place_of_utm(500000, 0, 31, false), 0, 3);
  is_near(place_of_utm(500123.4, 5790456.7, 33, false), 52.264494418137, 15.001808185433);
  is_near(place_of_utm(297000, 6700000, 32, false), 60.385313328321, 5.316348902160);
  is_near(place_of_utm(334900.5, 6252300.25, 56, true), -33.856696345611, 151.215301403919);
}

TEST_CASE("the antimeridian and the poles are ordinary places") {
  CHECK(meters_apart({52, 179.999995}, {52, -179.999995}) ==
        Approx(meters_apart({52, 9.999995}, {52, 10.000005})).margin(1e-6));
  CHECK(meters_apart({52, 185}, {52, -175}) < 1e-6);
  CHECK(meters_apart({90, 0}, {90, 120}) < 1e-6);
  const LocalPlane pole(earth_position({90, 45}));
  for (const double meters : pole.local(earth_position({89.9999, 45})))
    CHECK(std::isfinite(meters));
}

TEST_CASE("a plane has east, north and up, and preserves distances") {
  const auto origin = earth_position({52, 13});
  const LocalPlane plane(origin);
  CHECK(length_between(plane.local(origin), {0, 0, 0}) < 1e-9);
  const auto east = plane.local(earth_position({52, 13.001}));
  CHECK(east[0] == Approx(68.678).margin(0.01));  // a N of 6 391 436 m, cos 52, 0.001 degrees
  CHECK(std::abs(east[1]) < 0.001);
  const auto north = plane.local(earth_position({52.001, 13}));
  CHECK(north[1] == Approx(111.267).margin(0.01));
  CHECK(std::abs(north[0]) < 1e-9);
  CHECK(length_between(east, north) ==
        Approx(meters_apart(Geographic{52, 13.001}, Geographic{52.001, 13})).margin(1e-8));
}

TEST_CASE("ten kilometers from its origin, a plane is 4 mm short and 8 m below") {
  const LocalPlane plane(earth_position({0, 0}));
  const double angle_deg = 10000 / 6378137.0 * 180 / std::numbers::pi;
  const auto far = plane.local(earth_position({0, angle_deg}));
  CHECK(far[0] == Approx(10000 - 0.0041).margin(0.0001));
  CHECK(far[2] == Approx(-7.839).margin(0.001));
  CHECK(length_between(far, {0, 0, 0}) == Approx(10000 - 0.001).margin(0.0001));
}

TEST_CASE("dates are read with fraction and time zone") {
  const auto time = parse_calendar_time("2024-05-01T12:34:56.789Z");
  REQUIRE(time);
  CHECK(*time == 1714566896789000000);
  CHECK(parse_calendar_time("2024-05-01T14:34:56.789+02:00") == time);
  CHECK(parse_calendar_time("2024-05-01 07:04:56,789-0530") == time);
  CHECK(parse_calendar_time("2024-05-01 12:34:56") == 1714566896000000000);
  CHECK(parse_calendar_time("2024-02-29T00:00:00.0000000019Z") == 1709164800000000001);
  CHECK(parse_calendar_time("1969-12-31T23:59:59Z") == -1000000000);
  for (const char* text :
       {"20240501T123456.789Z", "2024/05/01 12:34:56.789", "2024:05:01 12:34:56.789",
        "2024-05-01 12:34:56.789 UTC", "2024-05-01 12:34:56.789 +0000 UTC",
        "2024-05-01t12:34:56.789z", "2024-05-01 14:34:56.789 +02:00"})
    CHECK(parse_calendar_time(text) == time);
  for (const char* text : {"", "2024", "2023-02-29T00:00:00Z", "2024-05-01", "2024-05-01T24:00:00Z",
                           "2024-05-01T12:60:00Z", "2024-05-01T12:34:61Z", "2024-05-01T12:34:56.Z",
                           "2024-05-01T12:34:56ZZ", "2024-05-01T12:34:56+",
                           "2024-05-01T12:34:56+99", "1714566896", "2024-05:01 12:34:56",
                           "05/01/2024 12:34:56", "2024-05-01T12:34:56+02:", "0000-00-00 00:00:00",
                           "9999-01-01T00:00:00Z", "2024-5-1T1:2:3Z"})
    CHECK_FALSE(parse_calendar_time(text));
}

TEST_CASE("a route is read by column names") {
  test::write_text("p.csv", "frame,time,x,y,heading,floor\n0,0,1,2,90,a\n2,0.2,1.5,2.5,0,b\n");
  const auto route = read_routes({"p.csv"}).routes.front();
  REQUIRE(route.size() == 3);
  CHECK(route[0]->x == 1);
  CHECK(route[0]->floor == "a");
  CHECK_FALSE(route[1]);
  CHECK(route[2]->y == 2.5);
  CHECK(route[2]->floor == "b");
}

TEST_CASE("poses have the units that their columns name") {
  test::write_text("p.csv", "Frame,T_ms,x_mm,Y [cm],heading (rad)\n0,200,1500,250,3.14159265\n");
  const Trajectory found = read_pose_csv("p.csv", {}, /*with_times=*/true);
  CHECK(found.times_ns == std::vector<int64_t>{200'000'000});
  CHECK(found.poses[0]->position == std::array<double, 3>{1.5, 2.5, 0});
  CHECK(*found.poses[0]->heading_deg == Approx(180));
}

TEST_CASE("places and walls are read, with the first view of each place") {
  test::write_text("p.csv", "place,view,x,y\nb,0.jpg,1,2\nb,1.jpg,9,9\na,0.jpg,3,4\n");
  const auto places = read_place_positions("p.csv");
  REQUIRE(places.size() == 2);
  CHECK(places[0].x == 1);
  CHECK(places[1].y == 4);
  test::write_text("w.csv", "floor,x0,y0,x1,y1,kind\ng,0,0,5,0,wall\n");
  const auto walls = read_walls("w.csv");
  REQUIRE(walls.size() == 1);
  CHECK(walls[0].to.x == 5);
  CHECK(walls[0].from.floor == "g");
}

TEST_CASE("damaged routes are data errors") {
  for (const char* text :
       {"", "frame,x\n0,1\n", "frame,x,y\n0,1\n", "frame,x,y\n-1,1,1\n",
        "frame,x,y\n99999999999999999999,1,1\n", "frame,x,y\n0,one,1\n", "frame,x,y\n0,nan,1\n",
        "frame,x,y\n0,1e999,1\n", "frame,x,y\n0,1,1\n0,2,2\n"})
    CHECK(kind_of(text, [](const auto& path) { return read_routes({path}); }) == ErrorKind::data);
  CHECK(kind_of("x0,y0,x1\n0,0,0\n", read_walls) == ErrorKind::data);
  CHECK(kind_of("place,x\na,0\n", read_place_positions) == ErrorKind::data);
}
