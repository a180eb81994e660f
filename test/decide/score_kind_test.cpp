// The table of scores compared with the descriptions in other places.
#include "decide/score_kind.h"

#include <catch2/catch.hpp>

#include "base/json.h"
#include "decide/choices.h"
#include "match/score_kernels.h"
#include "support.h"

using namespace vpr;

TEST_CASE("each score has its entry") {
  REQUIRE(score_kinds().size() == kEnumNames<Score>.size() + 1);
  CHECK(&score_kinds().back() == &probability_kind());
  CHECK(probability_kind().order == ScoreOrder::similarity);
  CHECK_FALSE(score_kind(Score::raw).needs_statistics);
  CHECK(score_kind(Score::zscore).needs_statistics);
  CHECK_FALSE(score_kind(Score::zscore).is_offline);
  CHECK(score_kind(Score::zscore_offline).is_offline);
}

TEST_CASE("a sum of frame scores is converted to a value per frame, without its bias") {
  CHECK(score_kind(Score::raw).offset(7) == 0);
  CHECK(score_kind(Score::raw).frame_value(350, 7) == 50);
  for (const Score score : {Score::zscore, Score::zscore_offline}) {
    const ScoreKind& kind = score_kind(score);
    // Three frames, each 1.5 deviations closer than the mean.
    const auto sum = static_cast<uint32_t>(3 * kScoreBias - 3 * 1536);
    CHECK(sum - kind.offset(3) == -3 * 1536);
    CHECK(kind.frame_value(-3 * 1536, 3) == -1.5);
  }
}

TEST_CASE("sums of the longest windows fit, and none is below the value of a missing one") {
  for (const Score score : {Score::raw, Score::zscore, Score::zscore_offline}) {
    const ScoreKind& kind = score_kind(score);
    CHECK(-kind.offset(kind.longest_window) >= int64_t{kind.missing});
    // A sum of the largest frame scores fits 32 bits.
    const uint64_t most = kind.needs_statistics ? 65535 : 1386;
    CHECK(most * kind.longest_window <= 0xFFFFFFFF);
  }
}

TEST_CASE("files hold the settings of their own score") {
  SequenceQuerySettings settings;
  const auto keys = [&](Score score) {
    settings.score = score;
    std::vector<std::string> found;
    const Json json = settings_in_force(settings);
    for (const auto& item : json.items()) found.push_back(item.key());
    return found;
  };
  const std::vector<std::string> raw = {"method",          "c_l",           "t_r",
                                        "t_r_scale",       "safety_factor", "only_sequence",
                                        "skip_unreadable", "clustering",    "lsh"};
  std::vector<std::string> all = raw;
  all.insert(all.end(), {"score", "zscore"});
  CHECK(keys(Score::raw) == raw);
  CHECK(keys(Score::zscore) == all);
  CHECK(keys(Score::zscore_offline) == all);
}

TEST_CASE("a number is on the scale of its score by default") {
  SequenceQuerySettings settings;
  CHECK(scale_of(settings) == ThresholdScale::relative);
  settings.score = Score::zscore;
  CHECK(scale_of(settings) == ThresholdScale::mean_z);
  settings.threshold_scale = ThresholdScale::bits;
  CHECK(scale_of(settings) == ThresholdScale::bits);
  CHECK(test::error_kind([&] { ResolvedSettings{settings}; }) == ErrorKind::usage);
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
