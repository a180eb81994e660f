// A sequence against its own past in one call: results by definition, refused settings, and
// independence of later frames.
#include <algorithm>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/json.h"
#include "examples.h"
#include "loops/loops.h"
#include "query/run_query.h"
#include "query/sequence_query.h"
#include "reference/reference.h"
#include "reference/verified_query.h"
#include "support.h"
#include "truth/times.h"

using namespace vpr;
using test::make_query;

namespace {

// 30 frames, the same frames with a few other bits, and 10 new ones.
std::vector<LdbCode> two_laps() {
  std::vector<LdbCode> codes = test::walk_codes(30, 1);
  for (size_t f = 0; f < 30; ++f) {
    codes.push_back(codes[f]);
    for (size_t b = 0; b < 6; ++b) codes.back()[(7 * f + 11 * b) % 170] ^= 0xff;
  }
  for (const LdbCode& code : test::walk_codes(10, 99)) codes.push_back(code);
  return codes;
}

SequenceQuerySettings loop_settings(const Rule& rule, std::variant<uint64_t, double> gap) {
  SequenceQuerySettings settings{rule};
  settings.past = OwnPast{gap};
  return settings;
}

SequenceQuerySettings loop_settings(uint64_t length, uint64_t gap) {
  return loop_settings(Threshold{{.window_length = length}}, gap);
}

Result find_loops(const DescriptorSet& walk, const SequenceQuerySettings& settings,
                  std::span<const int64_t> times = {}) {
  QueryResources resources;
  const SequenceDatabase database = own_database(walk, "w");
  const QueryPlan plan =
      plan_query(prepare(database, settings, resources), walk, "w", settings, resources, {}, times);
  return test::run_verified(plan, 120, {}).result;
}

// For each window, the closest one that ends at least `gap` frames earlier; the first one on a tie.
std::vector<std::optional<Match>> slow_best(const std::vector<LdbCode>& codes, size_t length,
                                            size_t gap) {
  std::vector<std::optional<Match>> best;
  for (uint32_t j = 0; j + length <= codes.size(); ++j) {
    best.emplace_back();
    for (uint32_t i = 0; i + gap <= j; ++i) {
      const double distance = reference_window_distance(codes, i, codes, j, length);
      if (!best.back() || distance < best.back()->score) best.back() = {j, 0, i, 0, distance};
    }
  }
  return best;
}

}  // namespace

TEST_CASE("best matches of a sequence in its past equal the definition, for every exact method") {
  const std::vector<LdbCode> codes = two_laps();
  for (const char* method : {"fastable", "fastable-online", "openable"})
    for (const uint64_t gap : {1, 15, 31, 69, 70, 200})
      for (const size_t length : {1, 4, 20}) {
        const Threshold rule{{method, length}};
        INFO(method << ", gap " << gap << ", c_l " << length);
        const Result result = find_loops(make_query(codes), loop_settings(rule, gap));
        CHECK(result.best == slow_best(codes, length, gap));
        CHECK(result.recognitions.empty());  // there is no threshold
      }
}

TEST_CASE("recognitions of a sequence in its past are pairs below t_r, in bits per frame") {
  const std::vector<LdbCode> codes = two_laps();
  const Threshold rule{{.window_length = 4}, 60};
  const Result result = find_loops(make_query(codes), loop_settings(rule, uint64_t{15}));
  std::vector<Match> recognitions;
  for (uint32_t j = 15; j + 4 <= codes.size(); ++j)
    for (uint32_t i = 0; i + 15 <= j; ++i) {
      const double distance = reference_window_distance(codes, i, codes, j, 4);
      if (distance / 4 < 60) recognitions.push_back({j, 0, i, 0, distance});
    }
  CHECK(result.recognitions == recognitions);
  CHECK(recognitions.size() >= 27);
  // Each is a window of the second lap matched with the first.
  for (const ListedLoop& loop : loops_of(result)) CHECK(loop.query == loop.match + 30);
  CHECK(loops_of(result).size() == 27);
  CHECK(loops_of(result).front().query == 33);
  CHECK(loops_of(result).front().score == Approx(48));
}

TEST_CASE("a margin in the past excludes the gap around the best match") {
  const std::vector<LdbCode> codes = two_laps();
  const Margin rule{{.window_length = 3}, 30};
  const Result result = find_loops(make_query(codes), loop_settings(rule, uint64_t{12}));
  const auto best = slow_best(codes, 3, 12);
  for (uint32_t j = 0; j < best.size(); ++j) {
    std::optional<double> runner_up;
    for (uint32_t i = 0; best[j] && i + 12 <= j; ++i) {
      if (std::max(i, best[j]->train) - std::min(i, best[j]->train) <= 12) continue;
      const double distance = reference_window_distance(codes, i, codes, j, 3);
      runner_up = std::min(distance, runner_up.value_or(distance));
    }
    INFO("window " << j);
    REQUIRE(result.margins[j].has_value() == runner_up.has_value());
    if (runner_up) CHECK(*result.margins[j] == *runner_up - best[j]->score);
  }
  CHECK_FALSE(result.recognitions.empty());
}

TEST_CASE("results of a sequence do not change as it continues") {
  const std::vector<LdbCode> codes = two_laps();
  for (const Score score : {Score::raw, Score::zscore}) {
    const Threshold rule{{.window_length = 3, .score = score}};
    const SequenceQuerySettings settings = loop_settings(rule, uint64_t{12});
    const Result whole = find_loops(make_query(codes), settings);
    const std::vector<LdbCode> begin(codes.begin(), codes.begin() + 50);
    const Result part = find_loops(make_query(begin), settings);
    for (size_t j = 0; j < part.best.size(); ++j) {
      CHECK(part.best[j] == whole.best[j]);
      CHECK(part.margins[j] == whole.margins[j]);
    }
  }
}

TEST_CASE("a gap in seconds uses time stamps") {
  const std::vector<LdbCode> codes = two_laps();
  std::vector<int64_t> times;
  for (size_t f = 0; f < codes.size(); ++f) times.push_back(static_cast<int64_t>(f) * kSecond / 2);
  const SequenceQuerySettings settings = loop_settings(Threshold{{.window_length = 3}}, 7.5);
  CHECK(find_loops(make_query(codes), settings, times).best == slow_best(codes, 3, 15));
  const Json json = settings_in_force(settings);
  CHECK(json["loop_gap_s"] == 7.5);
  CHECK_FALSE(json.contains("loop_gap"));
}

TEST_CASE("unreadable frames of a sequence match nothing and are not matched") {
  DescriptorSet walk = make_query(two_laps());
  walk.sequence.unreadable = {5, 40};
  for (const Score score : {Score::raw, Score::zscore}) {
    const Threshold rule{{.window_length = 3, .score = score}};
    const SequenceQuerySettings settings = loop_settings(rule, uint64_t{12});
    const Result result = find_loops(walk, settings);
    for (const auto& best : result.best) {
      if (!best) continue;
      CHECK((best->query + 2 < 40 || best->query > 40));
      CHECK((best->train + 2 < 5 || best->train > 5));
    }
    CHECK_FALSE(result.best[39].has_value());
  }
}

TEST_CASE("a gap longer than the sequence finds nothing") {
  CHECK(loops_of(find_loops(make_query(two_laps()), loop_settings(5, 70))).empty());
  const std::vector<LdbCode> one = test::walk_codes(1, 4);
  CHECK(loops_of(find_loops(make_query(one), loop_settings(1, 1))).empty());
  CHECK_THROWS_AS(find_loops(make_query(one), loop_settings(2, 1)), Error);
  CHECK_THROWS_AS(find_loops(make_query(one), loop_settings(1, 0)), Error);
}

TEST_CASE("a list of loops refers to the frames of its trajectory") {
  const Result result = find_loops(make_query(two_laps()), loop_settings(3, 12));
  Trajectory trajectory;
  trajectory.name = "poses";
  trajectory.poses.assign(70, Pose{});
  const LoopList list = loop_list_of(result, "r.json", trajectory);
  CHECK(list.loops.size() == 68 - 12);
  CHECK(loops_csv({{14, 2, 51.5, 0}}) == "query,match,score\n14,2,51.5\n");
  trajectory.poses[2].reset();
  CHECK_THROWS_AS(loop_list_of(result, "r.json", trajectory), Error);
  trajectory.poses.pop_back();
  CHECK_THROWS_AS(loop_list_of(result, "r.json", trajectory), Error);
  Result other = result;
  std::get<SequenceQuerySettings>(other.settings).past.reset();
  trajectory.poses.assign(70, Pose{});
  CHECK_THROWS_AS(loop_list_of(other, "r.json", trajectory), Error);
}
