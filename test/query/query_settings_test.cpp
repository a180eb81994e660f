// Scores, thresholds on them, decisions, and settings in files.
#include "query/query_settings.h"

#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/random.h"
#include "match/match.h"
#include "match/score_kernels.h"
#include "match/zscores.h"
#include "query/choices.h"
#include "query/result.h"
#include "support.h"

using namespace vpr;

namespace {

SequenceQuerySettings margin_rule(std::optional<double> margin = std::nullopt) {
  return {Margin{{}, margin}};
}

Threshold scored_windows() { return {{.score = Score::zscore}}; }

bool is_refused(const SequenceQuerySettings& settings) {
  return test::error_kind([&] { check_settings(settings); }) == ErrorKind::usage;
}

}  // namespace

TEST_CASE("each score has its entry") {
  REQUIRE(score_kinds().size() == kEnumNames<Score>.size() + 1);
  CHECK(&score_kinds().back() == &probability_kind());
  CHECK(probability_kind().order == ScoreOrder::similarity);
  CHECK_FALSE(score_kind(Score::raw).needs_statistics);
  CHECK(score_kind(Score::zscore).needs_statistics);
}

TEST_CASE("a sum of frame scores is converted to a value per frame, without its bias") {
  CHECK(score_kind(Score::raw).offset(7) == 0);
  CHECK(score_kind(Score::raw).frame_value(350, 7) == 50);
  const ScoreKind& kind = score_kind(Score::zscore);
  // Three frames, each 1.5 deviations closer than the mean.
  const auto sum = static_cast<uint32_t>(3 * kScoreBias - 3 * 1536);
  CHECK(sum - kind.offset(3) == -3 * 1536);
  CHECK(kind.frame_value(-3 * 1536, 3) == -1.5);
}

TEST_CASE("sums of the longest windows fit, and none is below the value of a missing one") {
  const auto check = [](Score score, size_t longest_window, uint64_t largest_frame_score) {
    const ScoreKind& kind = score_kind(score);
    CHECK(-kind.offset(longest_window) >= int64_t{kind.missing});
    CHECK(largest_frame_score * longest_window <= 0xFFFFFFFF);
  };
  check(Score::raw, kMaxWindowLength, 1386);
  check(Score::zscore, kMaxScoredWindow, 65535);
}

TEST_CASE("files hold the keys of the rule in force, and what it implies") {
  const Json raw = settings_in_force(SequenceQuerySettings{});
  CHECK(raw["method"] == "fastable");
  CHECK(raw["t_r"] == "auto");
  CHECK(raw["t_r_scale"] == "relative");
  CHECK(raw["decide"] == "threshold");
  for (const char* other : {"lsh", "margin", "filter", "loop_gap", "loop_gap_s", "descriptor"})
    CHECK_FALSE(raw.contains(other));
  Json scored = settings_in_force(SequenceQuerySettings{scored_windows()});
  CHECK(scored["t_r_scale"] == "mean-z");
  scored["score"] = "raw";
  scored["t_r_scale"] = "relative";
  CHECK(scored == raw);
  const Json lsh = settings_in_force(SequenceQuerySettings{Lsh{5, 200.0}});
  CHECK(lsh["method"] == "lsh");
  CHECK(lsh["t_r_scale"] == "bits");
  CHECK(lsh.contains("lsh"));
  for (const char* other : {"margin", "filter", "exclusion_frames", "same_place"})
    CHECK_FALSE(lsh.contains(other));
  const Json filter = settings_in_force(SequenceQuerySettings{Filter{}});
  CHECK(filter["method"] == "filter");
  CHECK(filter["c_l"] == 1);
  CHECK(filter["score"] == "zscore");
  CHECK(filter["decide"] == "margin");
  CHECK(filter["margin"] == kFilterMargin);
  CHECK(filter.contains("filter"));
  for (const char* other : {"t_r", "t_r_scale", "safety_factor", "lsh", "exclusion_frames"})
    CHECK_FALSE(filter.contains(other));
  SequenceQuerySettings loop;
  loop.past = OwnPast{uint64_t{10}};
  const Json past = settings_in_force(loop);
  CHECK(past["t_r_scale"] == "bits");
  CHECK(past["exclusion_frames"] == 10);
  CHECK(past["loop_gap"] == 10);
  CHECK_FALSE(past.contains("loop_gap_s"));
}

TEST_CASE("keys of a rule are read as the same rule") {
  SequenceQuerySettings loop{Margin{{.window_length = 3}, 8.0}};
  loop.past = OwnPast{2.5, "hog"};
  for (const SequenceQuerySettings& settings :
       {SequenceQuerySettings{}, SequenceQuerySettings{scored_windows()},
        SequenceQuerySettings{Filter{9}}, SequenceQuerySettings{Lsh{5, 200.0}}, loop})
    CHECK(settings_in_force(query_of(keys_of(settings))) == settings_in_force(settings));
}

TEST_CASE("a number is on the scale of its score by default") {
  SequenceQuerySettings settings;
  CHECK(scale_of(settings) == ThresholdScale::relative);
  settings.rule = scored_windows();
  CHECK(scale_of(settings) == ThresholdScale::mean_z);
  settings.rule = Threshold{{.score = Score::zscore}, -1, ThresholdScale::bits};
  CHECK(scale_of(settings) == ThresholdScale::bits);
  CHECK(is_refused(settings));
  CHECK_FALSE(scale_of({Margin{}}));
}

TEST_CASE("FAB-MAP's settings are those in a file, and its windows are frames") {
  FabmapQuerySettings settings;
  settings.window = 5;
  CHECK(settings_in_force(settings) == value_to_json(settings));
  CHECK(window_length_of(settings) == 1);
  CHECK(method_of(settings) == "fabmap");
  CHECK(&score_of(settings) == &probability_kind());
  CHECK(is_better(0.9, 0.8, probability_kind().order));
  CHECK_FALSE(is_better(0.8, 0.8, probability_kind().order));
  CHECK(is_better(-2, 1, score_kind(Score::raw).order));
}

TEST_CASE("the limit is the smallest distance whose quotient is not below the threshold") {
  CHECK(distance_limit(0.4, 1000) == 400);  // 400 / 1000 < 0.4 is false
  CHECK(distance_limit(0.4, 1001) == 401);  // 400.4
  CHECK(distance_limit(1.0, 7) == 7);
  CHECK(distance_limit(0, 7) == 0);
  CHECK(distance_limit(-1, 7) == 0);
  CHECK(distance_limit(1e-300, 7) == 1);
}

TEST_CASE("with a divisor of zero, the quotient counts as zero") {
  CHECK(distance_limit(0.5, 0) == 1);
  CHECK(distance_limit(0, 0) == 0);
}

TEST_CASE("thresholds above every distance make every cell a recognition") {
  CHECK(distance_limit(1e300, 5) == std::numeric_limits<uint32_t>::max());
}

TEST_CASE("the limit equals the division, cell by cell") {
  RandomEngine engine(1);
  for (int i = 0; i < 2000; ++i) {
    const auto divisor = static_cast<uint32_t>(1 + uniform_below(engine, 70'000));
    const double threshold = uniform_unit(engine);
    const uint32_t limit = distance_limit(threshold, divisor);
    for (uint32_t d = limit < 3 ? 0 : limit - 3; d < limit + 3; ++d)
      REQUIRE((d < limit) == (static_cast<double>(d) / divisor < threshold));
  }
  // Exact quotients: multiplication instead of division would round differently.
  for (uint32_t divisor = 1; divisor < 300; ++divisor)
    for (uint32_t d = 0; d <= divisor; ++d)
      REQUIRE(distance_limit(static_cast<double>(d) / divisor, divisor) == d);
}

TEST_CASE("the limit of a mean z equals the division, also for negative thresholds") {
  CHECK(score_limit(0, 3) == 3 * 32768);
  CHECK(score_limit(-1, 1) == 32768 - 1024);
  CHECK(score_limit(-1.5, 10) == 10 * 32768 - 15360);  // -1.5 itself is not a recognition
  CHECK(score_limit(-32, 4) == 0);
  CHECK(score_limit(-1e300, 4) == 0);
  CHECK(score_limit(1e300, 4) == std::numeric_limits<uint32_t>::max());
  CHECK(mean_z(32768 - 1024, 1) == -1.0);
  RandomEngine engine(1);
  for (int i = 0; i < 2000; ++i) {
    const size_t length = 1 + uniform_below(engine, kMaxScoredWindow);
    const double threshold = 8 * uniform_unit(engine) - 6;
    const uint32_t limit = score_limit(threshold, length);
    for (uint32_t sum = limit - 3; sum < limit + 3; ++sum)
      REQUIRE((sum < limit) == (mean_z(sum, length) < threshold));
  }
}

TEST_CASE("each decision has an entry with the key of its setting") {
  const Json all = value_to_json(SequenceKeys{});
  for (const Decision decision : {Decision::threshold, Decision::margin})
    CHECK(all.contains(std::string(decision_kind(decision).symbol)));
}

TEST_CASE("files hold the settings of a margin") {
  Margin rule{{.exclusion_frames = 3, .same_place = {"a=b"}}, 12.5};
  const Json margin = settings_in_force(SequenceQuerySettings{rule});
  for (const char* key : {"t_r", "t_r_scale", "safety_factor"}) CHECK_FALSE(margin.contains(key));
  CHECK(margin["decide"] == "margin");
  CHECK(margin["margin"] == 12.5);
  CHECK(margin["exclusion_frames"] == 3);
  CHECK(margin["same_place"] == Json{"a=b"});
  CHECK(settings_in_force(margin_rule())["margin"] == "auto");
}

TEST_CASE("a margin must be a finite number, not negative, and below the largest distance") {
  CHECK_FALSE(is_refused(margin_rule()));
  CHECK_FALSE(is_refused(margin_rule(0)));
  CHECK_FALSE(is_refused(margin_rule(65535)));
  for (const double margin : {-0.1, std::nan(""), double{INFINITY}, 65536.0})
    CHECK(is_refused(margin_rule(margin)));
  CHECK_FALSE(is_refused({Margin{{.score = Score::zscore}, 64}}));
  CHECK(is_refused({Margin{{.score = Score::zscore}, 65}}));
  CHECK(is_refused({Filter{65}}));
}

TEST_CASE("the default margin is a share of 1 / sqrt(c_l)") {
  CHECK(score_kind(Score::raw).default_margin(600, 9) == Approx(150));
  CHECK(score_kind(Score::zscore).default_margin(600, 1) == Approx(5.1));
  CHECK(score_kind(Score::zscore).default_margin(100, 16) == Approx(1.275));
}
