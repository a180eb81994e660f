// Decisions along paths, computed by hand and compared with each other.
#include "query/path_decisions.h"

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace vpr;

namespace {

/// A report that changes the places of the frames from `changed` on.
struct Step {
  PathReport report;
  std::vector<Cell> matches;

  Step(uint32_t path, uint32_t margin, size_t settled, uint32_t changed, uint32_t frame,
       size_t first = 0) {
    for (uint32_t f = changed; f <= frame; ++f) matches.push_back({f, 0, 100 * frame + f, 7});
    report = {path, margin, first, settled, {}, matches};
  }
};

std::vector<uint32_t> queries(const std::vector<Cell>& matches) {
  std::vector<uint32_t> frames;
  for (const Cell& match : matches) frames.push_back(match.query_window);
  return frames;
}

using Frames = std::vector<uint32_t>;

}  // namespace

TEST_CASE("a margin recognizes the settled frames of the path, with their last places") {
  PathDecisions decisions(10);
  CHECK(decisions.take(Step(1, 0, 0, 0, 0).report).empty());
  CHECK(decisions.take(Step(1, 9, 0, 0, 1).report).empty());
  CHECK(decisions.take(Step(1, 9, 1, 0, 2).report).empty());
  const auto recognized = decisions.take(Step(1, 10, 2, 1, 3).report);
  REQUIRE(queries(recognized) == Frames{0, 1});
  CHECK(recognized[0].train_window == 200);  // of the report at frame 2
  CHECK(recognized[1].train_window == 301);
  CHECK(queries(decisions.take(Step(1, 12, 3, 2, 4).report)) == Frames{2});
  CHECK(queries(decisions.finish()) == Frames{3, 4});
}

TEST_CASE("a margin that comes too late recognizes younger frames only") {
  PathDecisions decisions(10);
  decisions.take(Step(1, 0, 3, 0, 4).report);
  CHECK(queries(decisions.take(Step(1, 10, 4, 3, 5, 2).report)) == Frames{2, 3});
  CHECK(queries(decisions.finish()) == Frames{4, 5});
}

TEST_CASE("a path may begin at frames whose places still change") {
  PathDecisions decisions(10);
  CHECK(decisions.take(Step(1, 0, 0, 0, 5).report).empty());
  CHECK(queries(decisions.take(Step(1, 20, 6, 3, 6, 5).report)) == Frames{5});
  CHECK(queries(decisions.take(Step(1, 20, 8, 6, 8, 7).report)) == Frames{7});
  CHECK(queries(decisions.finish()) == Frames{8});
}

TEST_CASE("a path that ends does not recognize its open frames") {
  PathDecisions decisions(10);
  decisions.take(Step(1, 20, 1, 0, 3).report);
  CHECK(queries(decisions.take(Step(2, 0, 4, 4, 4, 4).report)).empty());
  CHECK(queries(decisions.take(Step(2, 20, 5, 4, 5, 4).report)) == Frames{4});
  decisions.end_path();
  CHECK(decisions.finish().empty());
}

TEST_CASE("a path that changes its pass keeps its open frames") {
  PathDecisions decisions(10);
  CHECK(decisions.take(Step(1, 0, 0, 0, 3).report).empty());
  CHECK(queries(decisions.take(Step(2, 20, 2, 2, 4).report)) == Frames{0, 1});
}

TEST_CASE("settled margins accept what decisions recognize") {
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    RandomEngine engine(seed);
    std::vector<PathReport> steps;
    PathDecisions decisions(10);
    Frames recognized;
    const auto take = [&](const std::vector<Cell>& matches) {
      for (const uint32_t frame : queries(matches)) recognized.push_back(frame);
    };
    uint32_t path = 1;
    uint32_t begin = 0;
    uint32_t settled = 0;
    for (uint32_t frame = 0; frame < 100; ++frame) {
      if (uniform_below(engine, 25) == 0) {  // unreadable
        decisions.end_path();
        steps.push_back({});
        ++path;
        begin = settled = frame + 1;
        continue;
      }
      if (uniform_below(engine, 25) == 0) {
        ++path;
        begin = settled = frame;
      }
      if (uniform_below(engine, 25) == 0) ++path;  // another pass
      const uint32_t first = settled;
      if (frame >= begin + 3) settled = std::max(settled, frame - 3);
      const uint32_t oldest = std::max(begin, frame - std::min(frame, 9U));
      const auto margin = static_cast<uint32_t>(uniform_below(engine, 11));
      const Step step(path, margin, settled, first, frame, oldest);
      steps.push_back({path, margin, oldest, settled});
      take(decisions.take(step.report));
    }
    if (steps.back().path != 0) take(decisions.finish());
    const std::vector<uint32_t> margins = settled_margins(steps);
    Frames accepted;
    for (uint32_t frame = 0; frame < margins.size(); ++frame)
      if (margins[frame] >= 10) accepted.push_back(frame);
    INFO("seed " << seed);
    CHECK(accepted == recognized);
    CHECK(accepted.size() < 90);
  }
}
