#include <catch2/catch.hpp>

#include "support.h"
#include "truth/ground_truth.h"

using namespace vpr;
using namespace vpr::test;

namespace {

const std::string kHeader = "query,reference,label,tolerance\n";

/// The labels of a file, for 3 query frames and 10 training frames.
GroundTruth read_labels_of(const std::string& text, int tolerance = 0) {
  write_text("labels.csv", text);
  return read_ground_truth({"", "labels.csv", tolerance}, {{"q", 3}, {{{"t", 10}}}});
}

/// One character per training frame: s same, d different, i ignore.
std::string row_of(const GroundTruth& truth, size_t query) {
  std::vector<PlaceLabel> labels(10);
  truth.label_row(query, 0, labels);
  std::string row;
  for (const PlaceLabel label : labels) row += enum_name(label)[0];
  return row;
}

}  // namespace

TEST_CASE("pairs without a label are unknown") {
  const GroundTruth truth = read_labels_of(kHeader + "0,4,same,1\n2,3,different,0\n2,9,same,2\n");
  CHECK(row_of(truth, 0) == "iiisssiiii");
  CHECK(row_of(truth, 1) == "iiiiiiiiii");
  CHECK(row_of(truth, 2) == "iiidiiisss");
  CHECK(truth.has_match(0));
  CHECK_FALSE(truth.has_match(1));
  REQUIRE(truth.asked.size() == 3);
  CHECK(truth.asked[2].size() == 2);
  CHECK(row_of(read_labels_of(kHeader + "1,5,different,0\n"), 1) == "iiiiidiiii");
  CHECK(read_labels_of(kHeader + "1,5,different,0\n").has_match(1));
}

TEST_CASE("labels without rows, out of range or in contradiction are refused") {
  const auto refused = [](const std::string& rows, const std::string& words, int tolerance = 0) {
    CHECK_THROWS_WITH(read_labels_of(kHeader + rows, tolerance), Catch::Contains(words));
  };
  refused("", "has no labels");
  refused("3,0,same,1\n", "query 3 is out of range");
  refused("0,10,same,1\n", "reference 10 is out of range");
  refused("0,1,maybe,1\n", "neither same nor different");
  refused("0,1,same,-1\n", "tolerance \"-1\"");
  refused("0,4,same,1\n0,5,different,0\n", "both same and different");
  refused("0,4,same,1\n", "has its own tolerance", 2);
}
