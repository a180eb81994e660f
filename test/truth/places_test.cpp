// FAB-MAP's places that a person marked.
#include "truth/places.h"

#include <catch2/catch.hpp>

#include "truth/truth_files.h"

using namespace vpr;
using test::check_refused;
using test::read_labels;
using test::write_text;

namespace {

const std::string kPlacesHeader = "sequence,train,query,tolerance\n";

/// The labels of a file, for `query` frames and `places` places.
std::string labels_of(const std::string& rows, size_t query, size_t places) {
  write_text("places.csv", kPlacesHeader + rows);
  return read_labels("places.csv", query, places);
}

}  // namespace

TEST_CASE("marked places are in the order of their first rows") {
  write_text("places.csv", "query,tolerance,train,sequence\n7,1,40,b\n,,3,a\n20,2,40,b\n");
  const std::vector<MarkedPlace> places = read_marked_places("places.csv");
  REQUIRE(places.size() == 2);
  CHECK((places[0].sequence == "b" && places[0].frame == 40));
  CHECK((places[1].sequence == "a" && places[1].frame == 3));
  REQUIRE(places[0].visits.size() == 2);
  CHECK((places[0].visits[1].query == 20 && places[0].visits[1].tolerance == 2));
  CHECK(places[1].visits.empty());
}

TEST_CASE("a marked place is the same within the tolerance, and ignored as far again") {
  CHECK(labels_of("a,5,3,1\na,9,,\n", 7, 2) == ".. i. S. S. S. i. ..");
  CHECK(labels_of("a,5,3,0\n", 5, 1) == ". . . S .");
  CHECK(labels_of("a,5,0,2\n", 6, 1) == "S S S i i .");
  CHECK(labels_of("a,5,5,9\n", 6, 1) == "S S S S S S");
  // Two visits: the same place where one of them has it.
  CHECK(labels_of("a,5,1,1\na,5,4,1\n", 8, 1) == "S S S S S S i .");
}

TEST_CASE("marked places that do not fit are refused") {
  check_refused([] { labels_of("", 5, 1); }, "has no places");
  check_refused([] { labels_of("a,5,5,0\n", 5, 1); }, "query 5 is out of range");
  check_refused([] { labels_of("a,5,3,0\n", 5, 2); }, "is for 1 training frames, but there are 2");
  check_refused([] { labels_of("a,x,3,0\n", 5, 1); }, "line 2");
  check_refused([] { labels_of("a,5,3,\n", 5, 1); }, "line 2");
  check_refused([] { labels_of(",5,3,0\n", 5, 1); }, "the sequence is empty");
  check_refused(
      [] {
        inspect_ground_truth({"", "places.csv"}, {{"", kUnknownFrames}, {{"", kUnknownFrames}}});
      },
      "number of query frames", ErrorKind::usage);
}
