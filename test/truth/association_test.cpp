// Poses at the times of frames.
#include <cmath>
#include <cstdlib>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/error.h"
#include "base/random.h"
#include "truth/frame_times.h"
#include "truth/times.h"
#include "truth/trajectory.h"
#include "truth/truth_files.h"

using namespace vpr;
using test::by_positions;
using test::read_labels;
using test::write_text;

namespace {

Trajectory at(const std::vector<std::pair<int64_t, double>>& times_and_xs) {
  Trajectory trajectory;
  trajectory.name = "poses.txt";
  for (const auto& [time, x] : times_and_xs) {
    trajectory.poses.emplace_back(Pose{{x, 2 * x, 0}, x, {}});
    trajectory.times_ns.push_back(time);
  }
  return trajectory;
}

/// Compares every frame with every pose.
Poses reference_poses_at(const Trajectory& trajectory, const std::vector<int64_t>& frames,
                         const AssociationRules& rules) {
  Poses poses;
  for (const int64_t frame : frames) {
    const int64_t time = frame + rules.offset_ns;
    std::optional<size_t> before;
    std::optional<size_t> after;
    size_t nearest = 0;
    for (size_t i = 0; i < trajectory.poses.size(); ++i) {
      const int64_t at = trajectory.times_ns[i];
      if (at <= time) before = i;
      if (at >= time && !after) after = i;
      if (std::abs(at - time) < std::abs(trajectory.times_ns[nearest] - time)) nearest = i;
    }
    poses.emplace_back();
    if (std::abs(trajectory.times_ns[nearest] - time) > rules.max_difference_ns) continue;
    poses.back() = trajectory.poses[nearest];
    if (!before || !after || before == after) continue;
    const Pose& a = *trajectory.poses[*before];
    const Pose& b = *trajectory.poses[*after];
    const double share =
        static_cast<double>(time - trajectory.times_ns[*before]) /
        static_cast<double>(trajectory.times_ns[*after] - trajectory.times_ns[*before]);
    for (size_t k = 0; k < 3; ++k)
      poses.back()->position[k] = a.position[k] + share * (b.position[k] - a.position[k]);
  }
  return poses;
}

bool are_alike(const Poses& a, const Poses& b) {
  if (a.size() != b.size()) return false;
  for (size_t i = 0; i < a.size(); ++i) {
    if (a[i].has_value() != b[i].has_value()) return false;
    if (a[i] && (a[i]->position != b[i]->position || a[i]->heading_deg != b[i]->heading_deg))
      return false;
  }
  return true;
}

}  // namespace

TEST_CASE(
    "positions are interpolated between the neighboring poses, within the maximum difference") {
  const Trajectory trajectory = at({{100, 0}, {200, 10}, {1000, 20}});
  AssociationRules rules;
  rules.max_difference_ns = 60;
  const std::vector<int64_t> frames = {39, 40, 100, 140, 150, 260, 261, 1000, 1060, 1061};
  const Poses poses = poses_at(trajectory, frames, rules);
  CHECK_FALSE(poses[0]);              // 61 before the first
  CHECK(poses[1]->position[0] == 0);  // 60: the bound is inclusive
  CHECK(poses[2]->position[0] == 0);
  CHECK(poses[3]->position[0] == Approx(4));
  CHECK(poses[3]->position[1] == Approx(8));
  CHECK(poses[3]->heading_deg == 0.0);            // of the nearest pose
  CHECK(poses[4]->heading_deg == 0.0);            // of the earlier one on a tie
  CHECK(poses[5]->position[0] == Approx(10.75));  // 60 of 800
  CHECK_FALSE(poses[6]);
  CHECK(poses[7]->position[0] == 20);
  CHECK(poses[8]->position[0] == 20);
  CHECK_FALSE(poses[9]);
  rules.offset_ns = 100;
  CHECK(poses_at(trajectory, std::vector<int64_t>{100}, rules)[0]->position[0] == 10);
}

TEST_CASE("one pass over both times equals comparing every frame with every pose") {
  RandomEngine random = named_engine(3, "association");
  for (int trial = 0; trial < 200; ++trial) {
    Trajectory trajectory;
    int64_t time = 0;
    for (size_t i = 0; i < 1 + uniform_below(random, 20); ++i) {
      time += 1 + static_cast<int64_t>(uniform_below(random, 30));
      trajectory.times_ns.push_back(time);
      const double x = uniform_unit(random);
      trajectory.poses.emplace_back(Pose{{x, -x, 1}, 90 * x, {}});
    }
    std::vector<int64_t> frames;
    int64_t frame = -20;
    for (size_t i = 0; i < 25; ++i)
      frames.push_back(frame += 1 + static_cast<int64_t>(uniform_below(random, 25)));
    const AssociationRules rules{static_cast<int64_t>(uniform_below(random, 12)),
                                 static_cast<int64_t>(uniform_below(random, 9)) - 4};
    CHECK(are_alike(poses_at(trajectory, frames, rules),
                    reference_poses_at(trajectory, frames, rules)));
  }
}

TEST_CASE("frames without poses cause a warning with the median difference, or an error") {
  const Trajectory trajectory = at({{0, 0}, {kSecond, 1}, {2 * kSecond, 2}});
  test::Warnings warnings;
  associate(trajectory, std::vector<int64_t>{0, kSecond, 5 * kSecond, 6 * kSecond}, {}, "walk",
            warnings.monitor);
  CHECK(warnings.said.empty());  // exactly half causes no warning
  associate(trajectory, std::vector<int64_t>{0, 5 * kSecond, 6 * kSecond}, {}, "walk",
            warnings.monitor);
  REQUIRE(warnings.said.size() == 1);
  CHECK(test::has(warnings.said[0], "walk: 2 of 3 frames have no pose within 0.02 s"));
  CHECK(test::has(warnings.said[0], "cover 0 to 6 s, but poses.txt covers 0 to 2 s"));
  CHECK(test::has(warnings.said[0], "the median difference to the nearest pose is 3 s"));
  const auto apart = [&] {
    associate(trajectory, std::vector<int64_t>{5 * kSecond, 6 * kSecond}, {}, "walk",
              warnings.monitor);
  };
  CHECK(test::error_kind(apart) == ErrorKind::data);
  CHECK(test::has(test::error_text(apart), "use --offset"));
}

TEST_CASE("frames between distant poses need a larger difference") {
  const Trajectory trajectory = at({{0, 0}, {kSecond / 10, 1}, {kSecond / 5, 2}});
  test::Warnings warnings;
  // 25 ms before and after poses: a signed median would be near 0.
  associate(trajectory, std::vector<int64_t>{0, 75'000'000, 125'000'000, 175'000'000}, {}, "walk",
            warnings.monitor);
  REQUIRE(warnings.said.size() == 1);
  CHECK(test::has(warnings.said[0],
                  "nearest pose is 0.025 s. Poses are 0.1 s apart: --max-difference 0.05?"));
}

TEST_CASE("a trajectory with another rate than the images is ground truth by time") {
  const std::string rest = " 0 0 0 0 0 1\n";
  // Ten meters per second, ten poses per second; images every 0.25 s, and every 0.5 s an hour
  // later.
  std::string query;
  std::string train;
  for (int i = 0; i <= 20; ++i) {
    query += fmt::format("{:.1f} {}", 1000 + i * 0.1, i) + rest;
    train += fmt::format("{:.1f} {}", 4600 + i * 0.1, i) + rest;
  }
  write_text("q.txt", query);
  write_text("r.txt", train);
  write_text("q.times", "# image time\n1000\n1000.25\n1000.5\n1000.75\n");
  write_text("r.times", "0\n0.5\n1\n");
  GroundTruthArgument argument = by_positions("q.txt", "r.txt", 2.5);
  argument.options.query.times = "q.times";
  argument.options.train.times = "r.times";
  argument.options.max_difference_s = 0.05;
  argument.options.train.offset_s = 4600;
  // Query frames at 0, 2.5, 5 and 7.5 meters; training frames at 0, 5 and 10.
  CHECK(read_labels(argument, 4, 3) == "S.. SS. .S. .SS");
  argument.options.train.offset_s = 1e10;
  CHECK(test::error_text([&] { read_labels(argument, 4, 3); }).find("--train-offset") == 0);
  argument.options.train.offset_s = 4600;
  argument.options.max_difference_s = 0.01;  // 1000.25 and 1000.75 are between poses
  CHECK(read_labels(argument, 4, 3) == "S.. iii .S. iii");
  CHECK(test::error_kind([&] { read_labels(argument, 5, 3); }) == ErrorKind::data);
  argument.options.train.offset_s.reset();
  CHECK(test::error_kind([&] { read_labels(argument, 4, 3); }) == ErrorKind::data);
  argument.options.train.times.clear();
  argument.options.train.offset_s = 1;
  CHECK(test::error_kind([&] { read_labels(argument, 4, 21); }) == ErrorKind::usage);
  argument.options.train.offset_s.reset();
  argument.options.max_difference_s = -1;
  CHECK(test::error_kind([&] { read_labels(argument, 4, 21); }) == ErrorKind::usage);
  argument.options.query.times.clear();
  argument.options.max_difference_s = 0.05;  // without any times
  CHECK(test::error_kind([&] { read_labels(argument, 21, 21); }) == ErrorKind::usage);
  argument.options.max_difference_s.reset();
  // pose i belongs to frame i, as without times
  CHECK(read_labels(argument, 21, 21).size() == 21 * 22 - 1);
}

TEST_CASE("KITTI's poses have their times in another file, and EuRoC's are in nanoseconds") {
  write_text("k.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 8 0 1 0 0 0 0 1 0\n");
  write_text("k.times", "1.5e+00\n2.5e+00\n");
  write_text("frames.csv", "time\n1.5\n2\n2.5\n");
  GroundTruthArgument argument = by_positions("k.txt", "k.txt", 4);
  argument.options.max_difference_s = 0.5;
  argument.options.query.times = "frames.csv";
  CHECK(test::has(test::error_text([&] { read_labels(argument, 3, 2); }), "--query-pose-times"));
  argument.options.query.pose_times = "k.times";
  argument.options.train.times = "frames.csv";
  CHECK(test::has(test::error_text([&] { read_labels(argument, 3, 2); }), "--train-pose-times"));
  argument.options.train.times.clear();
  CHECK(read_labels(argument, 3, 2) == "S. SS .S");
  write_text("e.csv",
             "#timestamp [ns],x,y,z,qw,qx,qy,qz\n1403636580000000000,0,0,0,1,0,0,0\n"
             "1403636581000000000,8,0,0,1,0,0,0\n");
  write_text("e.times", "1403636580000000000,a.png\n1403636580500000000,b.png\n");
  GroundTruthArgument euroc{"", "e.csv", 0, argument.options};
  euroc.options.reference = "e.csv";
  euroc.options.query.times = "e.times";
  // two sources of times
  CHECK(test::error_kind([&] { read_labels(euroc, 2, 2); }) == ErrorKind::usage);
  euroc.options.query.pose_times.clear();
  CHECK(read_labels(euroc, 2, 2) == "S. SS");
}

TEST_CASE("names of images are times") {
  std::filesystem::create_directory("walk");
  for (const char* name : {"1305031102.25.png", "1305031101.5.png", "1305031103.png"})
    test::write_image(std::string("walk/") + name, 1);
  CHECK(read_frame_times("walk", {}, {}) ==
        std::vector<int64_t>{1305031101500000000, 1305031102250000000, 1305031103000000000});
  CHECK(read_frame_times("walk@1:2", {}, {}) == std::vector<int64_t>{1305031102250000000});
  test::write_image("walk/last.png", 1);
  CHECK(test::has(test::error_text([&] { read_frame_times("walk", {}, {}); }),
                  "last.png: \"last\" is not a valid time"));
}
