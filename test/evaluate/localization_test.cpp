#include <catch2/catch.hpp>

#include "base/error.h"
#include "evaluate/judgment.h"
#include "queries.h"
#include "support.h"
#include "truth/positions.h"

using namespace vpr;

namespace {

std::vector<Verdict> path(const std::string& text) {
  std::vector<Verdict> verdicts;
  for (const char c : text)
    verdicts.push_back(c == 'r'   ? Verdict::correct
                       : c == 'w' ? Verdict::incorrect
                       : c == 'i' ? Verdict::ignored
                                  : Verdict::none);
  return verdicts;
}

}  // namespace

TEST_CASE("a path with three verdicts, computed by hand") {
  const std::vector<double> traveled = {0, 1, 2, 3, 10, 11, 12, 13, 14, 15};
  const Localization found = localize(path("..r.wr...r"), traveled);
  CHECK(found.frames == 10);
  CHECK(found.correct == 3);
  CHECK(found.incorrect == 1);
  CHECK(found.first_recognition_frames == 2);
  CHECK(found.first_recognition_m == 2);
  CHECK(found.longest_gap_frames == 3);  // frames 6 to 8
  CHECK(found.recognized == 4);
  CHECK(found.longest_gap_m == 9);  // from frame 2 to frame 5
}

TEST_CASE("the first recognition counts when it is decided") {
  const std::vector<double> traveled = {0, 1, 2, 3};
  const Localization found =
      localize(path(".r.r"), traveled, std::vector<std::optional<uint32_t>>{{}, 3, {}, 3});
  CHECK(found.first_recognition_frames == 3);
  CHECK(found.first_recognition_m == 3);
  CHECK(found.longest_gap_frames == 1);
}

TEST_CASE("gaps end at the ends of the path") {
  const std::vector<double> traveled = {0, 2, 4, 6, 8};
  const Localization late = localize(path("...r."), traveled);
  CHECK(late.longest_gap_frames == 3);
  CHECK(late.longest_gap_m == 6);
  const Localization early = localize(path("r...."), traveled);
  CHECK(early.longest_gap_frames == 4);
  CHECK(early.longest_gap_m == 8);
  CHECK(early.first_recognition_frames == 0);
  CHECK(early.first_recognition_m == 0);
}

TEST_CASE("a path without a fix is one gap, and an incorrect recognition does not end it") {
  const Localization found = localize(path("ww.w"), std::vector<double>{0, 1, 1, 5});
  CHECK(found.correct == 0);
  CHECK(found.incorrect == 3);
  CHECK(found.longest_gap_frames == 4);
  CHECK(found.longest_gap_m == 5);
  CHECK_FALSE(found.first_recognition_frames);
  CHECK_FALSE(found.first_recognition_m);
}

TEST_CASE("the share is of the frames with a match") {
  Localization found = localize(path("rrw..r"), {});
  CHECK_FALSE(found.share());
  found.frames_with_match = 4;
  CHECK(*found.share() == 0.75);
}

TEST_CASE("without positions there are no meters, and an empty path has no share") {
  const Localization found = localize(path("r.r"), {});
  CHECK(found.longest_gap_frames == 1);
  CHECK_FALSE(found.longest_gap_m);
  CHECK_FALSE(found.first_recognition_m);
  const Localization empty = localize({}, {});
  CHECK_FALSE(empty.share());
  CHECK(empty.longest_gap_frames == 0);
}

TEST_CASE("a fix in every frame leaves no gap") {
  const Localization found = localize(path("rrrr"), std::vector<double>{0, 1, 3, 4});
  CHECK(found.longest_gap_frames == 0);
  CHECK(found.longest_gap_m == 2);  // between two verdicts
}

TEST_CASE("the closest recognition of a window is its fix, at the anchor") {
  Result result = test::make_result(6, 3, 6);
  result.recognitions = {
      {0, 0, 0, 0, 9}, {0, 0, 3, 0, 8}, {1, 0, 1, 0, 5}, {1, 0, 2, 0, 5}, {3, 0, 3, 0, 1}};
  GroundTruth truth = test::aligned_truth(6, 5);
  truth.pairs[5].push_back({0, 5, PlaceLabel::ignore});
  CHECK(verdicts_of(result, truth) == path("..wr.i"));
}

TEST_CASE("best matches are verdicts up to the threshold, inclusive") {
  Outcomes outcomes;
  for (size_t frame = 0; frame < 4; ++frame) {
    QueryOutcome& query = outcomes.queries.emplace_back();
    query.frame = frame;
    query.verdict = frame == 1 ? Verdict::incorrect : Verdict::correct;
    query.best = FrameMatch{0, frame};
    query.key = 10 + frame;
  }
  CHECK(verdicts_of(outcomes, 12) == path("rwr."));
  CHECK(verdicts_of(outcomes, std::nullopt) == path("...."));
}

TEST_CASE("distances traveled are sums of straight lines") {
  test::write_text("p.csv", "frame,x,y,heading\n1,3,4,0\n0,0,0,0\n2,3,5.5,90\n");
  CHECK(read_traveled("p.csv", {"", 3}) == std::vector<double>{0, 5, 6.5});
  test::write_text("all.csv", "# a recording\nframe,x,y\n5,3,+4\n3,0,0\n9,1,1\n");
  CHECK(read_traveled("all.csv@3:6:2", {"", 2}) == std::vector<double>{0, 5});
}

TEST_CASE("distances of a resampled query follow its frames") {
  test::write_text("p.csv", "frame,x,y\n0,0,0\n1,3,4\n2,3,5\n");
  const auto traveled_by = [&](const std::string& speed) {
    return read_traveled("p.csv", selected(Sequence{"", 3}, at_speed(speed, 3, 1)));
  };
  CHECK(traveled_by("0.5") == std::vector<double>{0, 0, 5, 5, 6, 6});
  CHECK(traveled_by("reversed") == std::vector<double>{0, 1, 6});
}

TEST_CASE("there are no meters if a frame has no pose") {
  test::write_text("p.csv", "frame,x,y\n0,0,0\n3,1,1\n");
  CHECK(read_traveled("p.csv", {"", 4}).empty());
}

TEST_CASE("damaged positions are refused") {
  const test::TemporaryFolder folder;
  const std::string csv = GENERATE("", "x,y\n", "frame,x,y\n0,0,0\n0,1,1\n",
                                   "frame,x,y\n0,0,0\n2,1,1\n", "frame,x,y\n0,0,0\n1,a,1\n",
                                   "frame,x,y\n0,0,0\n1,1\n", "frame,x,y\n0,0,0\n1,nan,1\n",
                                   "frame,x,y\n0,0,0\n-1,1,1\n", "frame,x,y\n0,0,0\n1,inf,1\n");
  test::write_text(folder / "p.csv", csv);
  CHECK(test::error_kind([&] { read_traveled(folder / "p.csv", {"", 2}); }) == ErrorKind::data);
}
