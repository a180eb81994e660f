// Times, trajectories with times, and lists of loop closures.
#include "truth/trajectory.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "loops/loops.h"
#include "truth/frame_times.h"
#include "truth/times.h"
#include "truth/truth_files.h"

using namespace vpr;

namespace {

struct TextFiles {
  test::TemporaryFolder folder;

  std::filesystem::path operator()(const std::string& name, const std::string& content) const {
    test::write_text(folder / name, content);
    return folder / name;
  }
};

constexpr const char* kNoTurn = " 0 0 0 0 0 0 1\n";

LoopList read_loops(const std::filesystem::path& path, const Trajectory& trajectory,
                    LoopFrames frames = LoopFrames::automatic) {
  LoopListRules rules;
  rules.frames = frames;
  return read_loop_list(path, trajectory, rules);
}

}  // namespace

TEST_CASE("times are exact to the nanosecond, and their magnitude determines their unit") {
  CHECK(parse_time("1305031102.175304", TimeUnit::seconds) == 1305031102175304000);
  CHECK(parse_time("0.0000000019", TimeUnit::seconds) == 1);
  CHECK(parse_time("-1.5", TimeUnit::seconds) == -1500000000);
  CHECK(parse_time(".5", TimeUnit::milliseconds) == 500000);
  CHECK(parse_time("1403636579763555584", TimeUnit::nanoseconds) == 1403636579763555584);
  CHECK(parse_time("1.036000e-01", TimeUnit::seconds) == 103600000);
  CHECK_FALSE(parse_time("4611686018427387905", TimeUnit::nanoseconds));   // 2^62 + 1
  CHECK_FALSE(parse_time("-2305843009213693953", TimeUnit::nanoseconds));  // -2^61 - 1
  CHECK_FALSE(parse_time("1e300", TimeUnit::seconds));
  CHECK_FALSE(parse_time("99999999999", TimeUnit::seconds));
  CHECK_FALSE(parse_time("1.2.3", TimeUnit::seconds));
  CHECK_FALSE(parse_time("", TimeUnit::seconds));
  CHECK(unit_of_time("1305031102.175304") == TimeUnit::seconds);
  CHECK(unit_of_time("1305031102175") == TimeUnit::milliseconds);
  CHECK(unit_of_time("1305031102175304") == TimeUnit::microseconds);
  CHECK(unit_of_time("1305031102175304000") == TimeUnit::nanoseconds);
  CHECK_FALSE(unit_of_time("nan"));
  CHECK(time_text(1305031102175304000) == "1305031102.175304");
  CHECK(time_text(-20000000) == "-0.02");
  CHECK(time_text(5000000000) == "5");
}

TEST_CASE("the unit of times follows from their step, not from their digits") {
  const auto unit = [](const std::vector<std::string_view>& texts) {
    return unit_of_times({"t.txt"}, texts);
  };
  // Phones count from their start: 5 and 47 hours in nanoseconds.
  CHECK(unit({"18000000000000", "18000100000000"}) == TimeUnit::nanoseconds);
  CHECK(unit({"170000000000000", "170000033333333"}) == TimeUnit::nanoseconds);
  CHECK(unit({"0", "100", "200"}) == TimeUnit::milliseconds);
  CHECK(unit({"0", "100000", "200000"}) == TimeUnit::microseconds);
  CHECK(unit({"0", "0.1", "0.2"}) == TimeUnit::seconds);
  CHECK(unit({"0", "1", "2"}) == TimeUnit::seconds);
  CHECK(unit({"2.5", "7.5"}) == TimeUnit::seconds);
  // Dates, also with the steps of a mocap system and of a time lapse.
  CHECK(unit({"1403636580838555648", "1403636580839555648"}) == TimeUnit::nanoseconds);
  CHECK(unit({"1403636580838555", "1403636580839555"}) == TimeUnit::microseconds);
  CHECK(unit({"1403636580838", "1403636580938"}) == TimeUnit::milliseconds);
  CHECK(unit({"1403636580", "1403637180"}) == TimeUnit::seconds);
  // Two weeks since the start of a phone, or one frame per 100 seconds.
  CHECK_THROWS_WITH(unit({"1209600000000000", "1209600100000000", "1209601200000000"}),
                    Catch::Contains("they are 100000000 us or 100000000 ns apart"));
  // The median step, so gaps do not matter; nothing is known of one time.
  CHECK(unit({"0", "100", "200", "900000", "900100"}) == TimeUnit::milliseconds);
  CHECK(unit({"170000000000000"}) == TimeUnit::microseconds);
  CHECK_FALSE(unit({"2024-05-01T12:34:56Z", "2024-05-01T12:34:57Z"}));
  CHECK_FALSE(unit({}));
  CHECK(unit({"0", "5", "10"}) == TimeUnit::seconds);  // 10 ms are not a recording
  test::check_refused(
      [&] {
        unit({"0", "5", "10", "1000"});
      },
      "t.txt: the unit of its times is unclear: they are 5 s or 5 ms apart");
}

TEST_CASE("the nearest time is the earlier one on a tie") {
  const std::vector<int64_t> times = {10, 20, 40};
  CHECK(nearest_time(times, -5) == 0);
  CHECK(nearest_time(times, 15) == 0);
  CHECK(nearest_time(times, 16) == 1);
  CHECK(nearest_time(times, 30) == 1);
  CHECK(nearest_time(times, 31) == 2);
  CHECK(nearest_time(times, 999) == 2);
}

TEST_CASE("trajectories of TUM, EuRoC and KITTI are detected, with their times if they have any") {
  const TextFiles file;
  const Trajectory tum = read_trajectory(
      file("tum.txt", std::string("# t x y z q\n1.5 7 8 9 0 0 0 1\n2") + kNoTurn), {});
  REQUIRE(tum.poses.size() == 2);
  CHECK(tum.poses[0]->position == std::array<double, 3>{7, 8, 9});
  CHECK(tum.times_ns == std::vector<int64_t>{1500000000, 2000000000});
  const Trajectory euroc = read_trajectory(
      file("e.csv",
           "#timestamp [ns], x, y, z, qw, qx, qy, qz, v\n"
           "1403636580838555648,4.6, -1.7,0.8,1,0,0,0,9\n1403636580843555328,1,2,3,0,0,0,1,9\n"),
      {});
  REQUIRE(euroc.poses.size() == 2);
  CHECK(euroc.poses[0]->position == std::array<double, 3>{4.6, -1.7, 0.8});
  CHECK(euroc.times_ns[1] - euroc.times_ns[0] == 4999680);
  // The second pose is a half turn around z: w comes first.
  CHECK((*euroc.poses[1]->orientation)[0] == -1);
  CHECK((*euroc.poses[1]->orientation)[8] == 1);
  const auto kitti = file("k.txt", "1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 4 0 1 0 5 0 0 1 6\n");
  CHECK(read_trajectory(kitti, {}).times_ns.empty());
  const auto times = file("times.txt", "0.000000e+00\n1.036000e-01\n");
  CHECK(read_trajectory(kitti, times).times_ns == std::vector<int64_t>{0, 103600000});
  CHECK(test::error_kind([&] { read_trajectory(kitti, file("t1", "0\n")); }) == ErrorKind::data);
  CHECK(test::error_kind([&] { read_trajectory(file.folder / "tum.txt", times); }) ==
        ErrorKind::usage);
  CHECK(read_trajectory(file("p.csv", "frame,x,y\n2,5,6\n"), {}).poses.size() == 3);
  const auto named = file("n.csv", "image,x,y\nb.png,5,6\na.png,5,6\n");
  test::check_refused([&] { read_trajectory(named, times); }, "in any order", ErrorKind::usage);
  CHECK(test::error_kind([&] { read_trajectory(file("n", "1 2 3\n"), {}); }) == ErrorKind::usage);
}

TEST_CASE("times that decrease or repeat are refused with the line") {
  const TextFiles file;
  const auto falls = file("t.txt", std::string("2") + kNoTurn + "\n1" + kNoTurn);
  test::check_refused([&] { require_rising_times(read_trajectory(falls, {})); },
                      "t.txt, line 3: its time 1 is before the time of the previous frame, 2");
  const auto repeats = file("r.txt", "1\n1\n");
  CHECK(test::error_kind([&] { read_time_list(repeats); }) == ErrorKind::data);
  CHECK(test::error_kind([&] { read_time_list(file("w.txt", "1\nx\n")); }) == ErrorKind::data);
  CHECK(test::error_kind([&] { read_time_list(file("none.txt", "# t\n")); }) == ErrorKind::data);
}

TEST_CASE("lists of times may have headers, file names and ranges") {
  const TextFiles file;
  const std::vector<int64_t> both = {1500000000, 2250000000};
  CHECK(read_time_list(file("a.csv", "frame,time\n0,1.5\n1,2.25\n")) == both);
  CHECK(read_time_list(
            file("b.txt", "# timestamp filename\n1.5 rgb/1.5.png\n2.25 rgb/2.25.png\n")) == both);
  CHECK(read_time_list(file("c.csv", "1500000000000000000,a.png\n1500000000750000000,b.png\n")) ==
        std::vector<int64_t>{1500000000000000000, 1500000000750000000});
  CHECK(read_time_list(file("d.txt", "1\n2\n3\n4\n").string() + "@1:4:2") ==
        std::vector<int64_t>{2000000000, 4000000000});
  for (const char* text :
       {"frame,Time\n0,1.5\n1,2.25\n", "\"frame\",\"time\"\n0,1.5\n1,2.25\n",
        "frame;TIMESTAMP [s]\n0;1.5\n1;2.25\n", "frame,seconds\n0,1.5\n1,2.25\n",
        "time_ms\n1500\n2250\n", "nanoseconds\n1500000000\n2250000000\n", "time [ms]\n1500\n2250\n",
        "x [m] time ms y\n7 1500 1\n7 2250 2\n", "1970-01-01T00:00:01.5\n1970-01-01T00:00:02.25Z\n",
        "time\n1970-01-01 00:00:01.5\n1970-01-01 00:00:02.25+00:00\n",
        "1970-01-01 00:00:01.5 a\n1970-01-01 01:00:02.25 +01:00\n"})
    CHECK(read_time_list(file("h.csv", text)) == both);
  for (const char* text :
       {"frame,clock\n0,1.5\n", "secs,nsecs\n0,5\n", "seconds,nanoseconds\n0,5\n",
        "a.png,1.5\nb.png,2.25\n", "0,1.5\n1,2.25\n", "0 1.5\n1 2.25\n", "1,5\n2,25\n"})
    CHECK(test::has(test::error_text([&] { read_time_list(file("n.csv", text)); }), "time"));
  CHECK(test::has(
      test::error_text([&] { read_time_list(file("p.csv", "0\n1500000000.1\n1500000000.2\n")); }),
      "header of pandas"));
}

TEST_CASE("frames have the times of the lines that name their images") {
  const TextFiles file;
  const auto names_are = [](std::vector<std::string> all) -> NameReader {
    return [all = std::move(all)] { return all; };
  };
  const NameReader names = names_are({"9.png", "10.png"});
  const auto list = file("l.csv", "time,image\n1,rgb/8.png\n3,rgb/10.png\n2,rgb/9.png\n");
  CHECK(read_time_list(list, names) == std::vector<int64_t>{2 * kSecond, 3 * kSecond});
  CHECK(read_time_list(file("h.txt", "# times\n2 9.png\n3.5 10.png\n4 11.png\n"), names).back() ==
        3500000000);
  std::string far_apart;
  for (const int second : {30, 10, 40, 20})
    far_apart += fmt::format("{0}.0 {0}.png\n{1}.0 {1}.png\n", second, 69 - second);
  const NameReader early = names_are({"10.png", "20.png"});
  CHECK(read_time_list(file("s.txt", far_apart), early).front() == 10 * kSecond);
  CHECK(read_time_list(file("o.txt", "2 a.png\n3 b.png\n"), names).size() == 2);  // by order
  test::check_refused(
      [&] {
        read_time_list(list, names_are({"10.png", "11.png"}));
      },
      "has no time of 11.png");
  test::check_refused(
      [&] {
        read_time_list(list, names_are({"10.png", "9.png"}));
      },
      "l.csv, line 4: 9.png is not later than 10.png");
  test::check_refused([&] { read_time_list(file("t.txt", "2 9.png\n3 10.png\n4 9.png\n"), names); },
                      "t.txt, line 3: the image 9.png is listed twice");
  test::check_refused([&] { read_time_list(list); }, "l.csv, line 4: its time");

  // Names are read only if needed. They may be those of a video, or of a folder that is gone.
  const auto throws = [](ErrorKind kind) -> NameReader {
    return [kind]() -> std::vector<std::string> { throw Error(kind, "gone"); };
  };
  const auto named = file("n.txt", "2 b.png\n3 a.png\n");
  const std::vector<int64_t> in_order = {2 * kSecond, 3 * kSecond};
  CHECK(read_time_list(file("u.txt", "2\n3\n"), throws(ErrorKind::data)) == in_order);
  CHECK(read_time_list(named, throws(ErrorKind::usage)) == in_order);
  test::check_refused([&] { read_time_list(named, throws(ErrorKind::data)); }, "gone");
  std::string warning;
  Monitor monitor;
  monitor.warn = [&](const std::string& text) { warning = text; };
  CHECK(read_time_list(named, throws(ErrorKind::input), monitor) == in_order);
  CHECK(test::has(warning, "n.txt: names images, but those of its frames are unknown"));
}

TEST_CASE("loops have the unit of their trajectory, and gaps without effect are named") {
  const TextFiles file;
  std::string poses;
  for (int i = 0; i < 40; ++i)
    poses += fmt::format("{}{}", 18000000000000 + i * 100000000LL, kNoTurn);
  const Trajectory trajectory = read_trajectory(file("t.txt", poses), {});
  CHECK(trajectory.times_ns[1] - trajectory.times_ns[0] == 100000000);
  CHECK(read_loops(file("l.csv", "18003900000000,18000000000000\n"), trajectory).loops[0].query ==
        39);
  CHECK(read_loops(file("s.csv", "18003.9,18000.1\n"), trajectory).loops[0].match == 1);
  // numpy.savetxt writes all numbers so.
  CHECK(read_loops(file("n.csv", "3.9000000e+01,1.0000000e+00\n"), trajectory).loops[0].query ==
        39);
  const auto fault = [&](const char* gap) {
    return gap_fault(parse_loop_gap(gap, "--gap"), trajectory.times_ns, 40);
  };
  CHECK(fault("1s").empty());
  CHECK(fault("10").empty());
  CHECK(fault("0.1s") == "excludes no frame, because they are 0.1 s apart");
  CHECK(fault("10s") == "excludes nearly all frames, because they cover 3.9 s");
  CHECK(fault("39") == "excludes nearly all of the 40 frames");
}

TEST_CASE("equal times matter only where times are used") {
  const TextFiles file;
  const Trajectory repeated = read_trajectory(
      file("t.txt", std::string("1") + kNoTurn + "1" + kNoTurn + "2" + kNoTurn), {});
  const LoopList list = read_loops(file("l.csv", "2,0\n"), repeated);
  CHECK(judge_loops(list, repeated, {{1}, {{}, 1}}).loops.size() == 1);
  test::check_refused([&] { judge_loops(list, repeated, {{1}, {kSecond, 0}}); }, "t.txt, line 2");
}

TEST_CASE("loop closures are indices or time stamps, with or without scores") {
  const TextFiles file;
  std::string poses;
  for (const char* time : {"100.00", "100.10", "100.20", "100.30"})
    poses += time + std::string(kNoTurn);
  const Trajectory trajectory = read_trajectory(file("t.txt", poses), {});
  const LoopList plain = read_loops(file("l.txt", "# closures\n3 0\n\n2 1\n"), trajectory);
  CHECK_FALSE(plain.has_scores);
  REQUIRE(plain.loops.size() == 2);
  CHECK(plain.loops[1].query == 2);
  CHECK(plain.loops[1].match == 1);
  CHECK(plain.loops[1].line == 4);
  const LoopList named = read_loops(
      file("s.csv", "score,match,query\n0.5,100.0199,100.3\n-2,100.1,100.2\n"), trajectory);
  REQUIRE(named.loops.size() == 2);
  CHECK(named.loops[0].query == 3);
  CHECK(named.loops[0].match == 0);
  CHECK(named.loops[1].score == -2);
  // Integers beyond all frames are times, unless they are declared as indices.
  const Trajectory whole =
      read_trajectory(file("whole.txt", std::string("100") + kNoTurn + "101" + kNoTurn), {});
  const auto seconds = file("v.csv", "101,100\n");
  CHECK(read_loops(seconds, whole).loops.at(0).query == 1);
  CHECK(test::error_kind([&] { read_loops(seconds, whole, LoopFrames::index); }) ==
        ErrorKind::data);
}

TEST_CASE("unknown frames, loops to later frames and missing scores are refused with the line") {
  const TextFiles file;
  std::string poses;
  for (const char* time : {"100.00", "100.10", "100.20"}) poses += time + std::string(kNoTurn);
  const Trajectory trajectory = read_trajectory(file("t.txt", poses), {});
  const auto refused = [&](const std::string& content, const std::string& words) {
    test::check_refused([&] { read_loops(file("l.csv", content), trajectory); }, words);
  };
  refused("2,0\n3,0\n", "l.csv, line 2: there is no frame 3; the trajectory has 3 (0 to 2)");
  refused("1,-1\n", "line 1: match \"-1\" is not a frame number");
  refused("query,match\n0,2\n", "line 2: frame 0 closes a loop with the later frame 2");
  refused("1,1\n", "with itself");
  refused("100.2,100.05\n", "the pose nearest to the time 100.05 is 0.05 s away");
  refused("query,match,score\n2,0,0.5\n2,1,\n", "line 3: score \"\" is not a number");
  refused("2,0,0.5\n2,1\n", "line 2: expected 3 columns, found 2");
  refused("from,to\n1,0\n",
          "line 1: query \"from\" is not a frame number. A header has the columns "
          "query,match[,score]");
  refused("query,match,match\n1,0,0\n", "two columns match");
  refused("query,match,weight\n1,0,0\n", "unknown column \"weight\"");
  refused("match\n0\n", "has no column query. Expected query,match[,score]");
  Trajectory gap = trajectory;
  gap.poses[1].reset();
  CHECK(test::has(test::error_text([&] { read_loops(file("g.csv", "2,1\n"), gap); }),
                  "no pose for frame 1"));
  Trajectory untimed = trajectory;
  untimed.times_ns.clear();
  CHECK(test::error_kind([&] { read_loops(file("u.csv", "2.5,1.5\n"), untimed); }) ==
        ErrorKind::usage);
}
