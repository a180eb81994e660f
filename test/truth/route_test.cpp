#include <catch2/catch.hpp>

#include "base/error.h"
#include "support.h"
#include "truth/positions.h"

using namespace vpr;

namespace {

template <class Read>
std::optional<ErrorKind> kind_of(const std::string& text, Read read) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "f.csv", text);
  return test::error_kind([&] { read(folder / "f.csv"); });
}

}  // namespace

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
