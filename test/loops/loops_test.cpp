// Loop closures on a trajectory: by hand, and compared with all pairs of frames.
#include "loops/loops.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "evaluate/metrics.h"
#include "support.h"

using namespace vpr;

namespace {

/// One second apart, on a line.
Trajectory along(const std::vector<double>& xs) {
  Trajectory trajectory;
  for (const double x : xs) {
    trajectory.poses.emplace_back(Pose{{x, 0, 0}, {}, {}});
    trajectory.times_ns.push_back(static_cast<int64_t>(trajectory.poses.size()) * 1'000'000'000);
  }
  return trajectory;
}

LoopRules rules_within(double radius_m, size_t gap_frames) {
  return {{radius_m}, {{}, gap_frames}};
}

/// Compares every frame with every earlier one.
std::vector<bool> reference_frames_with_loop(const Trajectory& trajectory, const LoopRules& rules) {
  std::vector<bool> has_loop(trajectory.poses.size());
  for (size_t query = 0; query < has_loop.size(); ++query)
    for (size_t match = 0; match < query; ++match)
      if (trajectory.poses[query] && trajectory.poses[match] &&
          is_past(rules.gap, trajectory.times_ns, query, match) &&
          std::sqrt(square_distance(*trajectory.poses[query], *trajectory.poses[match])) <=
              rules.nearness.radius_m)
        has_loop[query] = true;
  return has_loop;
}

}  // namespace

TEST_CASE("loops in both directions equal those counted by hand") {
  // 0 1 2 3 meters and back: frames 4, 5 and 6 are at the positions of 2, 1 and 0.
  const Trajectory trajectory = along({0, 1, 2, 3, 2, 1, 0});
  LoopList list;
  list.has_scores = true;
  list.loops = {{4, 2, 0.1, 1},    // correct: 2 frames apart is the gap
                {5, 4, 0.95, 2},   // too close in time
                {5, 0, 0.8, 3},    // one meter away, with a radius of half a meter
                {5, 1, 0.7, 4},    // correct, but not its frame's best
                {4, 2, 0.9, 5},    // duplicate of the first one, with a better score
                {3, 0, 0.85, 6}};  // no place in common
  const LoopJudgment judgment = judge_loops(list, trajectory, rules_within(0.5, 2));
  CHECK(judgment.has_loop == std::vector<bool>{false, false, false, false, true, true, true});
  CHECK(judgment.repeated == 1);
  CHECK(judgment.count(PlaceLabel::same) == 2);
  CHECK(judgment.count(PlaceLabel::different) == 2);
  CHECK(judgment.count(PlaceLabel::ignore) == 1);
  CHECK(judgment.frames_with_loop() == 3);
  CHECK(judgment.frames_found() == 2);
  CHECK(judgment.revisits == std::vector<Revisit>{{4, 6, true}});
  CHECK(judgment.longest_missed() == Revisit{6, 6, false});
  // 0.9 is correct, 0.85 and 0.8 are incorrect (frame 5 also has a correct one with a lower score).
  REQUIRE(judgment.curve);
  CHECK(recall_at_full_precision(*judgment.curve).value == Approx(1 / 3.0));
  CHECK(average_precision(*judgment.curve).value == Approx(1 / 3.0));
}

TEST_CASE("bounds of radius and gap are inclusive, and small distances may be good scores") {
  const Trajectory trajectory = along({0, 10, 20, 0.5, 10, 20});
  LoopRules rules = rules_within(0.5, 1);
  rules.gap = {3'000'000'000, 0};
  CHECK(frames_with_loop(trajectory, rules) ==
        std::vector<bool>{false, false, false, true, true, true});
  rules.nearness.radius_m = 0.49;
  CHECK(frames_with_loop(trajectory, rules) ==
        std::vector<bool>{false, false, false, false, true, true});
  rules.gap.nanoseconds = 3'000'000'001;
  CHECK(frames_with_loop(trajectory, rules) == std::vector<bool>(6, false));
  rules = rules_within(0, 3);
  rules.order = ScoreOrder::distance;
  LoopList list;
  list.has_scores = true;
  list.loops = {{4, 1, 3.0, 1}, {5, 0, 7.0, 2}, {5, 2, 7.0, 3}};
  const LoopJudgment judgment = judge_loops(list, trajectory, rules);
  CHECK(judgment.revisits == std::vector<Revisit>{{4, 5, true}});
  CHECK(recall_at_full_precision(*judgment.curve).threshold == 3.0);
  CHECK(recall_at_full_precision(*judgment.curve).value == Approx(0.5));
}

TEST_CASE("frames without a pose have no loop, and an empty list finds nothing") {
  Trajectory trajectory = along({0, 5, 0, 0});
  trajectory.poses[2].reset();
  const LoopJudgment judgment = judge_loops({}, trajectory, rules_within(1, 1));
  CHECK(judgment.has_loop == std::vector<bool>{false, false, false, true});
  CHECK_FALSE(judgment.curve);
  CHECK(judgment.longest_missed() == Revisit{3, 3, false});
  CHECK(judge_loops({}, along({}), rules_within(1, 1)).revisits.empty());
}

TEST_CASE("an invalid radius, or a gap in time without times, is refused") {
  Trajectory trajectory = along({0, 1});
  CHECK(test::error_kind([&] { judge_loops({}, trajectory, rules_within(-1, 1)); }) ==
        ErrorKind::usage);
  trajectory.times_ns.clear();
  LoopRules rules = rules_within(1, 1);
  rules.gap.nanoseconds = 1;
  CHECK(test::error_kind([&] { judge_loops({}, trajectory, rules); }) == ErrorKind::usage);
}

TEST_CASE("a search in cubes equals comparing all pairs") {
  RandomEngine random = named_engine(7, "loops");
  for (int trial = 0; trial < 60; ++trial) {
    Trajectory trajectory;
    const double size = trial % 3 == 0 ? 1e18 : 4;
    for (int frame = 0; frame < 120; ++frame) {
      trajectory.times_ns.push_back(frame * 10);
      trajectory.poses.emplace_back();
      // Half of them on a grid, where distances equal the radius.
      const auto coordinate = [&] {
        const double x = static_cast<double>(uniform_below(random, 1001)) / 1000 * size - size / 2;
        return trial % 2 == 0 ? x : std::round(x);
      };
      if (uniform_below(random, 10) != 0)
        trajectory.poses.back() =
            Pose{{coordinate(), coordinate(), trial % 5 ? 0 : coordinate()}, {}, {}};
    }
    for (const double radius : {0.0, 0.1, 1.0, 1.5}) {
      LoopRules rules = rules_within(radius, 1 + uniform_below(random, 20));
      if (trial % 4 == 0) rules.gap.nanoseconds = 55;
      CHECK(frames_with_loop(trajectory, rules) == reference_frames_with_loop(trajectory, rules));
    }
  }
  // Within the radius after rounding, although two cubes are between them.
  const Trajectory rounded = along({-1e-17, 1});
  CHECK(frames_with_loop(rounded, rules_within(1, 1)) ==
        reference_frames_with_loop(rounded, rules_within(1, 1)));
}
