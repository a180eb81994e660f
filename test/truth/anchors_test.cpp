// Anchors: a few pairs with linear interpolation between them.
#include <catch2/catch.hpp>

#include "base/error.h"
#include "truth/ground_truth.h"
#include "truth/truth_files.h"

using namespace vpr;
using test::by_positions;
using test::read_labels;
using test::write_text;

TEST_CASE("frames between two anchors are interpolated, and frames outside have no place") {
  write_text("anchors.csv", "query,anchor\n1,0\n3,3\n");
  // Query 2 is at 1.5, rounded up to 2.
  CHECK(read_labels("anchors.csv", 5, 4) == ".... S... ..S. ...S ....");
  GroundTruthArgument wider{"", "anchors.csv", 1};
  CHECK(read_labels(wider, 5, 4) == ".... SS.. .SSS ..SS ....");
  // Backward as well.
  write_text("back.anchors.csv", "# walked back\nquery,anchor\n0,3\n3,0\n");
  CHECK(read_labels("back.anchors.csv", 4, 4) == "...S ..S. .S.. S...");
  write_text("one.csv", "query,reference\n1,2\n");
  CHECK(read_labels(GroundTruthArgument{"anchors", "one.csv"}, 3, 3) == "... ..S ...");
  // Query 29 is at 14.5: 29 / 50 is not exact.
  write_text("half.csv", "query,reference\n0,0\n50,25\n");
  CHECK(read_labels(GroundTruthArgument{"anchors", "half.csv"}, 51, 26).substr(29 * 27, 26) ==
        "...............S..........");
  write_text("none.csv", "query,reference\n");
  CHECK_THROWS_WITH(read_labels(GroundTruthArgument{"anchors", "none.csv"}, 2, 2),
                    Catch::Contains("has no anchors"));
}

TEST_CASE("a file with a column anchor has anchors, and one with references has pairs") {
  write_text("anchors.csv", "query,anchor\n0,0\n2,2\n");
  write_text("pairs.csv", "query,reference\n0,0\n2,2\n");
  CHECK(read_labels("anchors.csv", 3, 3) == "S.. .S. ..S");
  CHECK(read_labels("pairs.csv", 3, 3) == "S.. ... ..S");
  CHECK(read_ground_truth({"", "anchors.csv"}, {{"", 3}, {{"ref", 3}}}).protocol ==
        "anchors: 2 anchors, interpolated linearly, without places before and after them, within 0 "
        "frames");
}

TEST_CASE("pairs that may be anchors cause a warning") {
  const auto warnings = [&](const std::string& text, size_t frames, const std::string& format) {
    write_text("some.csv", text);
    size_t count = 0;
    Monitor monitor;
    monitor.warn = [&](const std::string& sentence) {
      CHECK(test::has(sentence, "some.csv labels 2 of 20 query frames"));
      ++count;
    };
    read_ground_truth({format, "some.csv"}, {{"", frames}, {{"ref", 99}}}, monitor);
    return count;
  };
  CHECK(warnings("query,reference\n0,0\n10,12\n", 20, "") == 1);
  CHECK(warnings("query,reference\n0,0\n10,12\n", 20, "pairs") == 0);
  CHECK(warnings("query,reference\n0,0\n10,12\n", 19, "") == 0);
  CHECK(warnings("query,reference\n10,12\n0,0\n", 20, "") == 0);
  CHECK(warnings("query,reference\n0,0\n0,1\n", 20, "") == 0);
  CHECK(warnings("query,reference,label\n0,0,same\n10,12,same\n", 20, "") == 0);
  CHECK(warnings("query,reference\n0,0\n", 20, "") == 0);
}

TEST_CASE("a tolerance of anchors in meters uses the poses of the training sequence") {
  write_text("anchors.csv", "query,anchor\n0,0\n2,3\n");
  // Half a meter between 1 and 2, so the middle, 1.5, is at 1.25 meters.
  write_text("r.csv", "frame,x,y\n0,0,0\n1,1,0\n2,1.5,0\n3,4,0\n5,1.25,0.25\n");
  GroundTruthArgument argument = by_positions("anchors.csv", "r.csv", 0.25);
  CHECK(read_labels(argument, 4, 6) == "S...i. .SS.iS ...Si. ......");
  // The same places as a trajectory of another rate, with half of its poses between frames.
  write_text("r.tum",
             "10 0 0 0 0 0 0 1\n10.5 0.5 0 0 0 0 0 1\n11 1 0 0 0 0 0 1\n"
             "12 1.5 0 0 0 0 0 1\n13 4 0 0 0 0 0 1\n15 1.25 0.25 0 0 0 0 1\n");
  write_text("times.txt", "10\n11\n12\n13\n14\n15\n");
  argument.options.reference = "r.tum";
  argument.options.train.times = "times.txt";
  CHECK(read_labels(argument, 4, 6) == "S...i. .SS.iS ...Si. ......");
  argument.options.train.times.clear();
  argument.options.reference = "r.csv";
  argument.options.radius_m.reset();
  CHECK(test::error_kind([&] { read_labels(argument, 4, 6); }) == ErrorKind::usage);
  argument.options = {};
  argument.options.radius_m = 1;
  CHECK(test::has(test::error_text([&] { read_labels(argument, 4, 6); }), "--ground-truth-train"));
  argument.options.reference = "r.csv";
  argument.tolerance_frames = 1;
  CHECK(test::error_kind([&] { read_labels(argument, 4, 6); }) == ErrorKind::usage);
}

TEST_CASE("anchors may name several sequences and have the query's range") {
  write_text("anchors.csv", "query,sequence,anchor\n0,a,0\n0,b,2\n2,a,2\n1,b,1\n");
  const GroundTruth truth = read_ground_truth({"", "anchors.csv"}, {{"", 3}, {{"a", 3}, {"b", 3}}});
  CHECK(truth.label(1, 0, 1) == PlaceLabel::same);
  CHECK(truth.label(1, 1, 1) == PlaceLabel::same);
  CHECK(truth.label(2, 0, 2) == PlaceLabel::same);
  CHECK(truth.label(2, 1, 0) == PlaceLabel::different);
  // A radius needs one searched sequence, and uses only its anchors.
  write_text("a.poses", "frame,x,y\n0,0,0\n1,1,0\n2,2,0\n");
  GroundTruthArgument near = by_positions("anchors.csv", "a.poses", 0);
  CHECK(test::draw(read_ground_truth(near, {{"", 3}, {{{"a", 3}}, {{"b", 3}, false}}}), 3, 3) ==
        "S.. .S. ..S");
  write_text("all.csv", "query,reference\n0,0\n10,5\n");
  GroundTruthArgument part{"anchors", "all.csv@4:9:2"};  // frames 4, 6 and 8
  CHECK(read_labels(part, 3, 6) == "..S... ...S.. ....S.");
}

TEST_CASE("anchors that decrease, repeat or are out of range are refused with the line") {
  const auto refused = [&](const std::string& lines, const std::string& words) {
    write_text("anchors.csv", "query,anchor\n" + lines);
    test::check_refused([&] { read_labels("anchors.csv", 5, 5); }, words);
  };
  refused("2,2\n1,3\n", "line 3: query 1 is not after the previous anchor, 2");
  refused("2,2\n2,3\n", "line 3");
  refused("2,5\n", "line 2: anchor 5 is out of range; there are 5 frames");
  refused("0,0\n7,2\n", "line 3: query 7 is out of range; there are 5 frames");
  refused("-1,2\n", "line 2");
  refused("1,2,3\n", "line 2");
  // Without known numbers of frames, as many as the anchors need.
  write_text("anchors.csv", "query,anchor\n1,2\n3,4\n");
  const auto found =
      inspect_ground_truth({"", "anchors.csv"}, {{"", kUnknownFrames}, {{"", kUnknownFrames}}});
  CHECK(found.scope.query.frames == 4);
  CHECK(found.scope.sequences[0].sequence.frames == 5);
}
