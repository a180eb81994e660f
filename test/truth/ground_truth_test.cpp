#include "truth/ground_truth.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "truth/truth_files.h"

using namespace vpr;

namespace {

GroundTruth read(const std::string& csv, const GroundTruthScope& scope, int tolerance = 0) {
  test::write_text("g.csv", csv);
  return read_ground_truth({"pairs", "g.csv", tolerance}, scope);
}

const GroundTruthScope kOne = {{"", 5}, {{"ref", 10}}};
const GroundTruthScope kTwo = {{"", 5}, {{"a", 10}, {"b, c", 4}}};

}  // namespace

TEST_CASE("pairs are three-valued") {
  const GroundTruth truth = read("query,reference,label\n1,2,same\n1,3,ignore\n2,9,\n", kOne);
  CHECK(truth.label(1, 0, 2) == PlaceLabel::same);
  CHECK(truth.label(1, 0, 3) == PlaceLabel::ignore);
  CHECK(truth.label(1, 0, 4) == PlaceLabel::different);
  CHECK(truth.label(2, 0, 9) == PlaceLabel::same);
  CHECK(truth.has_match(1));
  CHECK_FALSE(truth.has_match(0));
}

TEST_CASE("a tolerance extends pairs of the same place, not ignored pairs") {
  const GroundTruth truth =
      read("query,reference,label\n1,2,same\n1,8,ignore\n1,4,ignore\n", kOne, 2);
  CHECK(truth.label(1, 0, 0) == PlaceLabel::same);
  CHECK(truth.label(1, 0, 4) == PlaceLabel::same);
  CHECK(truth.label(1, 0, 5) == PlaceLabel::different);
  CHECK(truth.label(1, 0, 8) == PlaceLabel::ignore);
  CHECK(truth.label(1, 0, 9) == PlaceLabel::different);
}

TEST_CASE("pairs may use frame names if the scope has names") {
  GroundTruthScope scope = {{"", 3}, {{"ref", 3}}};
  scope.query_names = [] { return std::vector<std::string>{"a.png", "b.png", "7.png"}; };
  scope.sequences[0].names = [] { return std::vector<std::string>{"x.jpg", "y.jpg", "y.png"}; };
  const GroundTruth truth = read("query,reference\na.png,2\nb,x\n2,y.png\nc/7.png,1\n", scope);
  CHECK(truth.label(0, 0, 2) == PlaceLabel::same);
  CHECK(truth.label(1, 0, 0) == PlaceLabel::same);
  CHECK(truth.label(2, 0, 2) == PlaceLabel::same);
  CHECK(truth.label(2, 0, 1) == PlaceLabel::same);
  const auto error = [&](const std::string& row) {
    return test::error_text([&] { read("query,reference\n" + row + "\n", scope); });
  };
  CHECK(test::has(error("c.png,0"), "line 2: query \"c.png\" is neither"));
  // two candidates
  CHECK(test::has(error("a.png,y"), "reference \"y\" is neither"));
  scope.query.frames = 4;
  CHECK(test::has(error("a.png,0"), "has 3 names, but the result has 4 frames"));
  scope.query_names = nullptr;
  CHECK(test::has(error("a.png,0"), "--query and --train"));
}

TEST_CASE("digits of pairs are numbers or names, the same in all columns") {
  GroundTruthScope scope = {{"", 4}, {{"ref", 4}}};
  const auto names = [] { return std::vector<std::string>{"1.png", "2.png", "3.png", "4.png"}; };
  scope.query_names = scope.sequences[0].names = names;
  const auto labels = [&](const std::string& rows) {
    return test::draw(read("query,reference\n" + rows, scope), 4, 4);
  };
  CHECK(labels("1,2\n4,4\n") == ".S.. .... .... ...S");  // names
  CHECK(labels("1,0\n3,3\n") == ".... S... .... ...S");  // numbers, since 0 is not a name
  CHECK(labels("1.png,3\n2,3\n") == "..S. ..S. .... ....");
  const auto error = [&](const std::string& rows) {
    return test::error_text([&] { labels(rows); });
  };
  CHECK(test::has(error("1,2\n2,9\n"), "query 1 is the number of one frame and the name of"));
  CHECK(test::has(error("a,2\n2,2\n"), "query \"a\" is not the name"));
  CHECK(test::has(error("1.png,2\n2,2\n9,2\n"), "query 9 is not a name"));
  CHECK(test::has(error("01,2\n"), "query \"01\" is not the name"));
  scope.sequences[0].names = nullptr;
  CHECK(test::has(error("1,2\n"), "reference 2 is not a name"));
  CHECK(test::has(error("1,02\n"), "because of its leading zeros. Frames count from 0. To use"));
}

TEST_CASE("frame numbers that only a file states have an upper bound") {
  const auto error = [&](const std::string& format, const std::string& rows) {
    test::write_text("g.csv", "query,sequence,reference\n" + rows);
    return test::error_text([&] {
      inspect_ground_truth({format, "g.csv"}, {{"", kUnknownFrames}, {{"", kUnknownFrames}}});
    });
  };
  std::string anchors;
  std::string pairs;
  for (int s = 0; s < 16; ++s) {
    anchors += fmt::format("0,s{0},0\n4194303,s{0},4194303\n", s);
    pairs += fmt::format("4194303,s{0},0\n", s);
  }
  CHECK(test::has(error("anchors", anchors), "more than 16777216 runs"));
  CHECK(test::has(error("pairs", pairs), "4194304 query frames and 16 training sequences"));
}

TEST_CASE("the number of nearby poses is limited before the comparison") {
  std::string poses = "frame,x,y\n";
  for (int i = 0; i < 20000; ++i) poses += fmt::format("{},{},0\n", i, i % 2);
  test::write_text("p.csv", poses);
  const auto error = [&](double radius) {
    GroundTruthArgument argument = test::by_positions("p.csv", "p.csv", radius);
    return test::error_text([&] { read_ground_truth(argument, {{"", 20000}, {{"", 20000}}}); });
  };
  CHECK(test::has(error(1), "more than 134217728 pairs of frames lie within 1 m"));
}

TEST_CASE("places of FAB-MAP have no order, and so no tolerance") {
  GroundTruthScope places = kOne;
  places.has_places = true;
  CHECK(read("query,reference\n1,2\n", places).has_match(1));
  CHECK_THROWS_WITH(read("query,reference\n1,2\n", places, 1), Catch::Contains("have no order"));
}

TEST_CASE("a query whose pairs are all ignored has no match") {
  CHECK_FALSE(read("query,reference,label\n1,2,ignore\n", kOne).has_match(1));
}

TEST_CASE("the sequence column selects the training sequence") {
  const GroundTruth truth = read("query,sequence,reference\n0,\"b, c\",3\n", kTwo);
  CHECK(truth.label(0, 1, 3) == PlaceLabel::same);
  CHECK(truth.label(0, 0, 3) == PlaceLabel::different);
}

TEST_CASE("pairs of a sequence that was not searched count") {
  GroundTruthScope scope = kTwo;
  scope.sequences[1].searched = false;
  const GroundTruth truth = read("query,sequence,reference\n0,\"b, c\",3\n1,a,1\n", scope);
  CHECK(truth.has_match(0));
  CHECK(truth.has_match(1));
  CHECK(ground_truth_fingerprint(truth, scope) == ground_truth_fingerprint(truth, kTwo));
  CHECK(test::error_kind([&] { read("query,sequence,reference\n0,\"b, c\",4\n", scope); }) ==
        ErrorKind::data);
  CHECK(read("query,reference\n1,1\n", scope).label(1, 0, 1) == PlaceLabel::same);
}

TEST_CASE("several sequences need a sequence column") {
  CHECK(test::error_kind([] { read("query,reference\n1,1\n", kTwo); }) == ErrorKind::usage);
  CHECK(test::error_kind([] { read_ground_truth({"aligned", {}, 0}, kTwo); }) == ErrorKind::usage);
}

TEST_CASE("damaged pairs are refused with the line") {
  const std::string csv = GENERATE(
      "", "reference,other\n1,1\n", "query,reference\n1\n", "query,reference\n1,1,1\n",
      "query,reference\n5,1\n", "query,reference\n1,10\n", "query,reference\n-1,1\n",
      "query,reference\n1,x\n", "query,reference\n1,1.5\n", "query,reference\n1,2 3\n",
      "query,reference\n1,99999999999999999999999\n", "query,reference,label\n1,1,maybe\n",
      "query,sequence,reference\n1,zzz,1\n", "query,reference,label\n1,1,same\n1,1,ignore\n");
  CHECK(test::error_kind([&] { read(csv, kOne); }) == ErrorKind::data);
  CHECK(
      test::has(test::error_text([] { read("query,reference\n1,1\n\n1,10\n", kOne); }), "line 4"));
}

TEST_CASE("aligned: query frame i is training frame i, within the tolerance") {
  const GroundTruth exact = read_ground_truth({"aligned", {}, 0}, {{"", 12}, {{"ref", 10}}});
  CHECK(exact.label(3, 0, 3) == PlaceLabel::same);
  CHECK(exact.label(3, 0, 4) == PlaceLabel::different);
  CHECK(exact.has_match(9));
  CHECK_FALSE(exact.has_match(10));
  const GroundTruth near = read_ground_truth({"aligned", {}, 2}, {{"", 14}, {{"ref", 10}}});
  CHECK(near.label(3, 0, 1) == PlaceLabel::same);
  CHECK(near.label(3, 0, 6) == PlaceLabel::different);
  CHECK(near.has_match(11));
  CHECK(near.label(11, 0, 9) == PlaceLabel::same);
  CHECK_FALSE(near.has_match(12));
}

TEST_CASE("an unknown ground truth ignores every pair of the searched sequences") {
  const GroundTruth truth = unknown_ground_truth(
      {{"", 2}, {{{"a", 3}, true}, {{"b", 4}, false}, {{"c", 1}, true}, {{"d", 0}, true}}});
  CHECK_FALSE(truth.is_known);
  REQUIRE(truth.pairs.size() == 2);
  CHECK(truth.pairs[1].size() == 2);
  CHECK(truth.label(1, 0, 0) == PlaceLabel::ignore);
  CHECK(truth.label(1, 0, 2) == PlaceLabel::ignore);
  CHECK(truth.label(0, 2, 0) == PlaceLabel::ignore);
  CHECK_FALSE(truth.has_match(0));
}

namespace {

// Compares a resampled query with the labels of its recording, frame by frame.
void check_replayed(const std::string& argument, int tolerance) {
  GroundTruthArgument given = parse_ground_truth_argument(argument, tolerance);
  if (argument.ends_with("poses.csv")) {
    given.options.radius_m = 2;
    given.options.reference = "poses.csv";
  }
  const GroundTruthScope recorded = {{"", 60}, {{"ref", 60}}};
  const GroundTruth truth = read_ground_truth(given, recorded);
  for (const SpeedRule& rule : speed_rules()) {
    INFO(argument << ", " << rule.name);
    GroundTruthScope scope = recorded;
    scope.query = selected(scope.query, at_speed(std::string(rule.name), 60, 3));
    const GroundTruth at_speed = read_ground_truth(given, scope);
    REQUIRE(at_speed.pairs.size() == scope.query.frames);
    CHECK(test::has(at_speed.protocol, "query at speed "));
    for (size_t k = 0; k < scope.query.frames; ++k)
      for (size_t r = 0; r < 60; ++r)
        if (at_speed.label(k, 0, r) != truth.label(scope.query.selection.sources[k], 0, r))
          FAIL("frame " << k << " of the replay, reference " << r);
  }
}

}  // namespace

TEST_CASE("a resampled frame has the labels of its recorded frame, in every format") {
  std::string pairs = "query,reference,label\n";
  std::string poses = "frame,x,y\n";
  for (int q = 0; q < 60; ++q) {
    pairs += std::to_string(q) + "," + std::to_string(59 - q) + ",same\n";
    if (q % 7 == 0) pairs += std::to_string(q) + "," + std::to_string(q / 2) + ",ignore\n";
    poses += std::to_string(q) + "," + std::to_string(q * q % 40) + ",0\n";
  }
  test::write_text("pairs.csv", pairs);
  test::write_text("poses.csv", poses);
  const GroundTruthScope scope = {{"", 60}, {{"ref", 60}}};
  const InspectedGroundTruth truth = inspect_ground_truth({"pairs", "pairs.csv", 0}, scope);
  for (const char* name : {"matrix.npy", "matrix.npz"})
    test::write_truth(find_format("matrix"), truth, name);
  for (const char* name : {"pairs.csv", "poses.csv", "matrix.npy", "matrix.npz"})
    check_replayed(name, 1);
  check_replayed("aligned", 1);
  check_replayed("nordland-exact", 0);
}
