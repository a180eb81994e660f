// Thinning and resampling of a sequence.
#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <catch2/catch.hpp>

#include "base/text.h"
#include "recordings/sequence.h"
#include "recordings/sequence_json.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

constexpr int64_t kMs = 1'000'000;

std::vector<uint32_t> kept_at(const std::vector<int64_t>& times_ms, double fps) {
  std::vector<int64_t> times;
  for (const int64_t time : times_ms) times.push_back(time * kMs);
  return resampled(times, fps).sources;
}

// The reference implementation: compares every tick with every frame.
std::vector<uint32_t> plainly_kept(const std::vector<int64_t>& times, double fps) {
  std::vector<uint32_t> kept;
  const double interval = 1e9 / fps;
  const auto elapsed = [&](int64_t time) { return static_cast<double>(time - times[0]); };
  for (uint64_t k = 0; static_cast<double>(k) * interval <= elapsed(times.back()) + interval / 10;
       ++k) {
    const double tick = static_cast<double>(k) * interval;
    const auto nearest = std::ranges::min_element(
        times, {}, [&](int64_t time) { return std::abs(elapsed(time) - tick); });
    const auto frame = static_cast<uint32_t>(nearest - times.begin());
    if (kept.empty() || frame > kept.back()) kept.push_back(frame);
  }
  return kept;
}

std::vector<uint32_t> sources_of(const std::string& speed, size_t frames, uint64_t seed = 1) {
  return at_speed(speed, frames, seed).sources;
}

}  // namespace

TEST_CASE("the frame nearest to each tick is selected, each at most once") {
  // Ten frames per second.
  const std::vector<int64_t> even = {0, 100, 200, 300, 400, 500, 600, 700};
  CHECK(kept_at(even, 10) == std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 6, 7});
  CHECK(kept_at(even, 5) == std::vector<uint32_t>{0, 2, 4, 6});
  CHECK(kept_at(even, 1) == std::vector<uint32_t>{0});
  CHECK(kept_at(even, 1000) == std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 6, 7});
  // Ticks at 0, 250 (a tie), 500 and 750, which is too far after the last frame.
  CHECK(kept_at(even, 4) == std::vector<uint32_t>{0, 2, 5});
  CHECK(kept_at({0, 250, 500, 730}, 4) == std::vector<uint32_t>{0, 1, 2, 3});
  // Times may start anywhere and have a pause.
  CHECK(kept_at({9000, 9090, 9210, 20000, 20120, 20190}, 5) == std::vector<uint32_t>{0, 2, 3, 5});
  CHECK(kept_at({7}, 5) == std::vector<uint32_t>{0});
  CHECK(kept_at({}, 5).empty());
  const Selection kept = resampled(std::vector<int64_t>{5, 6}, 2);
  CHECK(kept.recorded_frames == 2);
  CHECK(kept.selected_fps == 2);
  CHECK(kept.speed.empty());
  CHECK(selection_text(kept) == "resampled to 2 frames per second");
}

TEST_CASE("selected frames equal those of the reference implementation") {
  std::mt19937 random(4);
  for (const double fps : {0.7, 3.0, 5.0, 9.7, 10.0, 14.0, 29.97, 90.0})
    for (const size_t frames : {1, 2, 3, 50, 200}) {
      std::vector<int64_t> times = {1'403'636'579'763'555'584};
      while (times.size() < frames)
        times.push_back(times.back() + 1 + static_cast<int64_t>(random() % 200'000'000));
      INFO(fps << " of " << frames);
      CHECK(resampled(times, fps).sources == plainly_kept(times, fps));
    }
}

TEST_CASE("a rate is the median of the intervals between frames") {
  const std::vector<int64_t> times = {0, 40 * kMs, 80 * kMs, 120 * kMs, 5000 * kMs};
  CHECK(median_fps(times) == Approx(25));
  CHECK_FALSE(median_fps(std::vector<int64_t>{3}));
  CHECK_FALSE(median_fps({}));
  CHECK(error_kind([] { check_fps(0, "--fps"); }) == ErrorKind::usage);
  CHECK(has(error_text([] { check_fps(1001, "--fps"); }), "at most 1000"));
}

TEST_CASE("a resampled selection refers to frames of the recording") {
  const Selection kept = resampled(std::vector<int64_t>{0, 100 * kMs, 200 * kMs, 300 * kMs}, 5);
  const Selection both =
      selected(Sequence{"", 2, {}, {}, {}, kept}, at_speed("reversed", 2, 1)).selection;
  CHECK(both.sources == std::vector<uint32_t>{2, 0});
  CHECK(both.recorded_frames == 4);
  CHECK(selection_text(both) == "resampled to 5 frames per second, at speed reversed, seed 1");
}

TEST_CASE("resampled frames of a file must increase and exist") {
  const auto read = [](const std::vector<int32_t>& rows, uint64_t recorded) {
    const Json json = {{"name", "a"},
                       {"frames", rows.size()},
                       {"resampled", {{"fps", 5.0}, {"frames", recorded}}}};
    const auto sequence = [&] {
      Sequence found;
      value_from_json(json, found, JsonSource{"a.json"}, "sequence");
      check_sequence(found, 10, {"a.json"});
      Sequence* const all = &found;
      read_sources(
          {&all, 1}, [&] { return rows; }, [] { throw Error(ErrorKind::data, "do not fit"); });
      return found;
    };
    if (error_kind(sequence)) return false;
    return std::ranges::equal(sequence().selection.sources, rows);
  };
  CHECK(read({0, 2, 4}, 5));
  CHECK_FALSE(read({0, 2, 5}, 5));
  CHECK_FALSE(read({0, 2, 2}, 5));
  CHECK_FALSE(read({-1, 2}, 5));
  CHECK_FALSE(read({}, 5));
  CHECK_FALSE(read({0, 1}, 2 * kMaxThinned + 1));
}

TEST_CASE("every kind of speed has its documented properties, for any length and seed") {
  for (const SpeedRule& rule : speed_rules())
    for (const size_t frames : {1, 2, 3, 39, 40, 41, 80, 81, 111, 1500})
      for (const uint64_t seed : {1, 2, 7}) {
        if (frames < rule.least_frames) continue;
        INFO(rule.name << " of " << frames << " frames, seed " << seed);
        const Selection one = at_speed(std::string(rule.name), frames, seed);
        CHECK(one.recorded_frames == frames);
        CHECK(one.seed == seed);
        CHECK(one.speed == rule.name);
        REQUIRE(!one.sources.empty());
        CHECK(*std::ranges::max_element(one.sources) < frames);
        CHECK(sources_of(std::string(rule.name), frames, seed) == one.sources);
      }
}

TEST_CASE("a speed p shows frame floor(k p), exactly") {
  CHECK(sources_of("0.5", 3) == std::vector<uint32_t>{0, 0, 1, 1, 2, 2});
  CHECK(sources_of("0.67", 4) == std::vector<uint32_t>{0, 0, 1, 2, 2, 3});
  CHECK(sources_of("1", 3) == std::vector<uint32_t>{0, 1, 2});
  CHECK(sources_of("1.5", 7) == std::vector<uint32_t>{0, 1, 3, 4, 6});
  CHECK(sources_of("2", 5) == std::vector<uint32_t>{0, 2, 4});
  CHECK(sources_of("2.0", 5) == sources_of("2", 5));
  CHECK(sources_of("10", 1) == std::vector<uint32_t>{0});
  // In floating point 0.29 * 100 is below 29.
  CHECK(sources_of("0.29", 30)[100] == 29);
}

TEST_CASE("reversed ends with the first frame, and kidnap shows every frame once") {
  CHECK(sources_of("reversed", 4) == std::vector<uint32_t>{3, 2, 1, 0});
  CHECK(sources_of("reversed", 1) == std::vector<uint32_t>{0});
  // Two parts have only one other order.
  const std::vector<uint32_t> two = sources_of("kidnap", 41);
  CHECK(two.front() == 40);
  CHECK(std::vector<uint32_t>(two.begin() + 1, two.begin() + 3) == std::vector<uint32_t>{0, 1});
  const std::vector<uint32_t> many = sources_of("kidnap", 1500, 3);
  CHECK(std::set<uint32_t>(many.begin(), many.end()).size() == 1500);
  size_t cuts = 0;
  for (size_t k = 1; k < many.size(); ++k) cuts += many[k] != many[k - 1] + 1;
  CHECK(cuts == 1500 / 40);  // 38 parts
}

TEST_CASE("stops repeat one frame 10 to 40 times after 20 to 60 moving frames") {
  const std::vector<uint32_t> sources = sources_of("stops", 1500, 5);
  CHECK(std::set<uint32_t>(sources.begin(), sources.end()).size() == 1500);
  size_t walked = 0;
  size_t stops = 0;
  for (size_t k = 0; k < sources.size();) {
    const size_t end =
        std::upper_bound(sources.begin(), sources.end(), sources[k]) - sources.begin();
    ++walked;
    if (end - k > 1) {
      CHECK(walked >= 20);
      CHECK(walked <= 60);
      CHECK(end - k - 1 >= 10);
      CHECK(end - k - 1 <= 40);
      walked = 0;
      ++stops;
    }
    k = end;
  }
  CHECK(stops >= 1500 / 60 - 1);
}

TEST_CASE("varying uses every speed, never skips more than a frame, and depends on the seed") {
  const std::vector<uint32_t> sources = sources_of("varying", 3000, 1);
  std::set<uint32_t> steps;
  for (size_t k = 1; k < sources.size(); ++k) steps.insert(sources[k] - sources[k - 1]);
  CHECK(steps == std::set<uint32_t>{0, 1, 2});
  CHECK(sources_of("varying", 3000, 2) != sources);
  CHECK(sources_of("kidnap", 3000, 2) != sources_of("kidnap", 3000, 1));
  CHECK(sources_of("stops", 3000, 2) != sources_of("stops", 3000, 1));
  CHECK(sources_of("1.5", 3000, 2) == sources_of("1.5", 3000, 1));
}

TEST_CASE("an unknown speed is refused with a list of the known ones") {
  for (const char* pace : {"0", "-1", "0.09", "10.1", "nan", "inf", "1e9"}) {
    INFO(pace);
    CHECK_THROWS_WITH(at_speed(pace, 10, 1), Catch::Contains("from 0.1 to 10"));
    CHECK_THROWS_AS(check_speed(pace), Error);
  }
  CHECK_THROWS_WITH(check_speed("varing"),
                    Catch::Contains("did you mean varying?") && Catch::Contains("kidnap"));
  CHECK_THROWS_AS(check_speed("2x"), Error);
  CHECK_THROWS_WITH(at_speed("kidnap", 3, 1), Catch::Contains("41 frames or more, found 3"));
  CHECK_NOTHROW(check_speed("kidnap"));
}

TEST_CASE("unreadable frames are unreadable wherever they are repeated") {
  const Selection slow = at_speed("0.5", 4, 1);
  CHECK(selected_frames(slow, std::vector<size_t>{1, 3}) == std::vector<size_t>{2, 3, 6, 7});
  CHECK(selected_frames(at_speed("2", 4, 1), std::vector<size_t>{1}).empty());
}
