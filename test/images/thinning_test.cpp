#include <algorithm>
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include "images/selection.h"
#include "support.h"

using namespace vpr;

namespace {

constexpr int64_t kMs = 1'000'000;

std::vector<uint32_t> kept_at(const std::vector<int64_t>& times_ms, double fps) {
  std::vector<int64_t> times;
  for (const int64_t time : times_ms) times.push_back(time * kMs);
  return thinned(times, fps).sources;
}

// Every tick looks at every frame.
std::vector<uint32_t> plainly_kept(const std::vector<int64_t>& times, double fps) {
  std::vector<uint32_t> kept;
  const double interval = 1e9 / fps;
  const auto behind = [&](int64_t time) { return static_cast<double>(time - times[0]); };
  for (uint64_t k = 0; static_cast<double>(k) * interval <= behind(times.back()) + interval / 10;
       ++k) {
    const double tick = static_cast<double>(k) * interval;
    const auto nearest = std::ranges::min_element(
        times, {}, [&](int64_t time) { return std::abs(behind(time) - tick); });
    const auto frame = static_cast<uint32_t>(nearest - times.begin());
    if (kept.empty() || frame > kept.back()) kept.push_back(frame);
  }
  return kept;
}

}  // namespace

TEST_CASE("The frame nearest to each tick is kept, and none twice") {
  // Ten frames a second.
  const std::vector<int64_t> even = {0, 100, 200, 300, 400, 500, 600, 700};
  CHECK(kept_at(even, 10) == std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 6, 7});
  CHECK(kept_at(even, 5) == std::vector<uint32_t>{0, 2, 4, 6});
  CHECK(kept_at(even, 1) == std::vector<uint32_t>{0});
  CHECK(kept_at(even, 1000) == std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 6, 7});
  // Ticks at 0, 250 (half way), 500 and 750, which is too far behind the last frame.
  CHECK(kept_at(even, 4) == std::vector<uint32_t>{0, 2, 5});
  CHECK(kept_at({0, 250, 500, 730}, 4) == std::vector<uint32_t>{0, 1, 2, 3});
  // Times start anywhere, and a pause is one.
  CHECK(kept_at({9000, 9090, 9210, 20000, 20120, 20190}, 5) == std::vector<uint32_t>{0, 2, 3, 5});
  CHECK(kept_at({7}, 5) == std::vector<uint32_t>{0});
  CHECK(kept_at({}, 5).empty());
  const Replay kept = thinned(std::vector<int64_t>{5, 6}, 2);
  CHECK(kept.recorded_frames == 2);
  CHECK(kept.fps == 2);
  CHECK(kept.warp.empty());
  CHECK(replay_text(kept) == "thinned to 2 frames a second");
}

TEST_CASE("Frames are kept as a look at all frames for every tick keeps them") {
  std::mt19937 random(4);
  for (const double fps : {0.7, 3.0, 5.0, 9.7, 10.0, 14.0, 29.97, 90.0})
    for (const size_t frames : {1, 2, 3, 50, 200}) {
      std::vector<int64_t> times = {1'403'636'579'763'555'584};
      while (times.size() < frames)
        times.push_back(times.back() + 1 + static_cast<int64_t>(random() % 200'000'000));
      INFO(fps << " of " << frames);
      CHECK(thinned(times, fps).sources == plainly_kept(times, fps));
    }
}

TEST_CASE("A rate is the median of what lies between frames") {
  const std::vector<int64_t> times = {0, 40 * kMs, 80 * kMs, 120 * kMs, 5000 * kMs};
  CHECK(median_fps(times) == Approx(25));
  CHECK_FALSE(median_fps(std::vector<int64_t>{3}));
  CHECK_FALSE(median_fps({}));
  CHECK(test::error_kind([] { check_fps(0, "--fps"); }) == ErrorKind::usage);
  CHECK(test::error_text([] { check_fps(1001, "--fps"); }).find("at most 1000") !=
        std::string::npos);
}

TEST_CASE("A replay of kept frames is one of the recording") {
  const Replay kept = thinned(std::vector<int64_t>{0, 100 * kMs, 200 * kMs, 300 * kMs}, 5);
  const Replay both = replay_of_kept(kept, replay("reversed", 2, 1));
  CHECK(both.sources == std::vector<uint32_t>{2, 0});
  CHECK(both.recorded_frames == 4);
  CHECK(replay_text(both) == "thinned to 5 frames a second, replayed by reversed, seed 1");
}

TEST_CASE("Kept frames of a file must rise and exist") {
  const auto read = [](const std::vector<int32_t>& sources, uint64_t frames) {
    return kept_frames(sources, frames, 5).has_value();
  };
  CHECK(read({0, 2, 4}, 5));
  CHECK_FALSE(read({0, 2, 5}, 5));
  CHECK_FALSE(read({0, 2, 2}, 5));
  CHECK_FALSE(read({-1, 2}, 5));
  CHECK_FALSE(read({}, 5));
  CHECK_FALSE(read({0, 1}, 2 * kMostThinned + 1));
}
