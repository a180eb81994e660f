// The table of choices: every refused combination is refused by name, and nothing else is.
#include "settings/choices.h"

#include <algorithm>
#include <bit>
#include <functional>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/json.h"

using namespace vpr;

namespace {

/// The flag of a choice, and its setting.
struct ChosenFlag {
  const char* flag;
  std::function<void(SequenceQuerySettings&)> set;  ///< null: a choice of the run alone
};

void by_margin(SequenceQuerySettings& settings) { settings.decision = Decision::margin; }

void by_loop(SequenceQuerySettings& settings) {
  settings.loop = true;
  if (settings.loop_gap_s == 0) settings.loop_gap = 10;
}

const std::vector<ChosenFlag> kChosenFlags = {
    {"DB", {}},
    {"vpr-query live", {}},
    {"vpr-query loops", by_loop},
    {"vpr-tune fastable", {}},
    {"a FAB-MAP database", {}},
    {"--method filter", [](auto& s) { s.method = "filter"; }},
    {"--method lsh", [](auto& s) { s.method = "lsh"; }},
    {"--method openable", [](auto& s) { s.method = "openable"; }},
    {"--score raw", {}},
    {"--score zscore", [](auto& s) { s.score = Score::zscore; }},
    {"--c-l", {}},
    {"--decide threshold", {}},
    {"--decide margin", by_margin},
    {"--t-r", [](auto& s) { s.distance_threshold = 0; }},
    {"--t-r-scale relative", [](auto& s) { s.threshold_scale = ThresholdScale::relative; }},
    {"--t-r-scale bits", [](auto& s) { s.threshold_scale = ThresholdScale::bits; }},
    {"--t-r-scale mean-z", [](auto& s) { s.threshold_scale = ThresholdScale::mean_z; }},
    {"--safety-factor", [](auto& s) { s.safety_factor = 0.9; }},
    {"--margin", [](auto& s) { s.margin = 3; }},
    {"--exclusion-frames", [](auto& s) { s.exclusion_frames = 3; }},
    {"--same-place", [](auto& s) { s.same_place = {"none"}; }},
    {"--only-sequence", [](auto& s) { s.only_sequences = {"a"}; }},
    {"--skip-unreadable", [](auto& s) { s.skip_unreadable = true; }},
    {"--save-matrix", {}},
    {"a --gap in seconds",
     [](auto& s) {
       s.loop_gap = 0;
       s.loop_gap_s = 3;
     }},
    {"--descriptor", [](auto& s) { s.descriptor = "hog"; }}};

const ChosenFlag& asked(std::string_view flag) {
  const auto found = std::find_if(kChosenFlags.begin(), kChosenFlags.end(),
                                  [&](const ChosenFlag& one) { return one.flag == flag; });
  REQUIRE(found != kChosenFlags.end());
  return *found;
}

/// The error for a combination of flags; empty without an error.
std::string error_of(const std::vector<std::string_view>& flags) {
  SequenceQuerySettings settings;
  Features run;
  for (const std::string_view flag : flags) {
    const ChosenFlag& one = asked(flag);
    if (one.set)
      one.set(settings);
    else
      run.push_back(enum_value<Feature>(flag).value());
  }
  try {
    ResolvedSettings(settings, run);
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::usage);
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("choices that cannot be combined are refused by both names") {
  struct Refused {
    std::vector<std::string_view> flags;
    std::string_view first, second;  ///< in the message
  };
  const std::vector<Refused> all = {
      // Scores and decisions.
      {{"--t-r-scale mean-z"}, "--t-r-scale mean-z", "--score raw"},
      {{"--score zscore", "--t-r", "--t-r-scale bits"}, "--t-r-scale bits", "--score zscore"},
      {{"--score zscore", "--t-r-scale relative", "--t-r"}, "relative", "zscore"},
      {{"--score zscore"}, "--t-r auto", "--score zscore"},
      {{"--score zscore", "--safety-factor", "--t-r"}, "--safety-factor", "zscore"},
      {{"--safety-factor", "--t-r"}, "--safety-factor", "--t-r"},
      {{"--score zscore", "--method openable"}, "--score zscore", "openable"},
      {{"--margin"}, "--margin", "--decide threshold"},
      {{"--decide margin", "--t-r"}, "--t-r", "--decide margin"},
      {{"--decide margin", "--t-r-scale bits"}, "--t-r-scale bits", "--decide margin"},
      {{"--decide margin", "--t-r-scale relative"}, "--t-r-scale relative", "--decide margin"},
      {{"--decide margin", "--safety-factor"}, "--safety-factor", "--decide margin"},
      // Methods.
      {{"--decide margin", "--method lsh"}, "--decide margin", "--method lsh"},
      {{"--score zscore", "--t-r", "--method lsh"}, "zscore", "--method lsh"},
      {{"--t-r", "--method lsh"}, "a relative --t-r", "--method lsh"},
      {{"--save-matrix", "--method lsh"}, "--save-matrix", "--method lsh"},
      {{"--t-r", "--method filter"}, "--t-r", "--method filter"},
      {{"--t-r-scale mean-z", "--method filter"}, "--t-r-scale mean-z", "--method filter"},
      {{"--safety-factor", "--method filter"}, "--safety-factor", "--method filter"},
      {{"--exclusion-frames", "--method filter"}, "--exclusion-frames", "--method filter"},
      {{"--c-l", "--method filter"}, "--c-l", "--method filter"},
      {{"--score raw", "--method filter"}, "--score raw", "--method filter"},
      {{"--decide threshold", "--method filter"}, "--decide threshold", "--method filter"},
      // A loop query.
      {{"vpr-query loops", "DB"}, "DB", "vpr-query loops"},
      {{"vpr-query loops", "vpr-query live"}, "vpr-query live", "vpr-query loops"},
      {{"vpr-query loops", "--method filter"}, "--method filter", "vpr-query loops"},
      {{"vpr-query loops", "--method lsh"}, "--method lsh", "vpr-query loops"},
      {{"vpr-query loops", "--t-r-scale relative"}, "relative", "vpr-query loops"},
      {{"vpr-query loops", "--decide margin"}, "a default --margin", "vpr-query loops"},
      {{"vpr-query loops", "a --gap in seconds", "--decide margin", "--margin"},
       "an automatic --exclusion-frames",
       "vpr-query loops"},
      {{"vpr-query loops", "--only-sequence"}, "--only-sequence", "vpr-query loops"},
      {{"vpr-query loops", "--same-place"}, "--same-place", "vpr-query loops"},
      {{"vpr-query loops", "vpr-tune fastable"}, "vpr-tune fastable", "vpr-query loops"},
      {{"DB", "--descriptor"}, "--descriptor", "its own past"},
      // Frames as they arrive.
      {{"vpr-query live", "--method openable"}, "vpr-query live", "--method openable"},
      {{"vpr-query live", "--method lsh"}, "vpr-query live", "--method lsh"},
      {{"vpr-query live", "--t-r"}, "a relative --t-r", "vpr-query live"},
      // FAB-MAP.
      {{"a FAB-MAP database", "a --gap in seconds"}, "--gap in seconds", "FAB-MAP"},
      {{"a FAB-MAP database", "vpr-query loops", "--descriptor"}, "--descriptor", "FAB-MAP"},
      // vpr-tune.
      {{"vpr-tune fastable", "--method filter"}, "vpr-tune fastable", "--method filter"},
      {{"vpr-tune fastable", "--method lsh"}, "vpr-tune fastable", "--method lsh"}};
  for (const Refused& one : all) {
    std::string flags;
    for (const std::string_view flag : one.flags) flags += std::string(flag) + " ";
    const std::string error = error_of(one.flags);
    INFO(flags << ": " << error);
    CHECK(error.find(one.first) < error.find(" does not go with "));
    CHECK(error.find(one.second, error.find(" does not go with ")) < error.size());
  }
}

TEST_CASE("choices that can be combined are accepted") {
  const std::vector<std::vector<std::string_view>> all = {
      {},
      {"--method openable", "--t-r", "--t-r-scale bits"},
      {"--method lsh", "--t-r", "--t-r-scale bits"},
      {"--method filter", "--margin", "--same-place", "--only-sequence"},
      {"--method filter", "vpr-query live"},
      {"vpr-query live", "--t-r", "--t-r-scale bits", "--skip-unreadable"},
      {"vpr-query live", "--t-r-scale relative"},
      {"vpr-query live", "--decide margin"},
      {"--score zscore", "--t-r", "--t-r-scale mean-z"},
      {"--score zscore", "--decide margin", "--margin", "--exclusion-frames"},
      {"--score zscore", "--decide margin", "--save-matrix"},
      {"vpr-query loops", "--descriptor", "--save-matrix"},
      {"vpr-query loops", "a --gap in seconds", "--score zscore", "--t-r"},
      {"vpr-query loops", "--decide margin", "--margin", "--method openable"},
      {"--score zscore", "--t-r", "--only-sequence", "--same-place"},
      {"vpr-tune fastable", "--score zscore", "--t-r"},
      {"vpr-tune fastable", "--decide margin", "--margin"},
      {"a FAB-MAP database", "vpr-query loops"}};
  for (const auto& flags : all) {
    std::string words;
    for (const std::string_view flag : flags) words += std::string(flag) + " ";
    INFO(words);
    CHECK(error_of(flags) == "");
  }
}

TEST_CASE("each facet is needed by a choice and excluded by another") {
  uint32_t needed = 0;
  uint32_t excluded = 0;
  const auto check = [&](std::string_view name, const auto& row) {
    INFO(name);
    CHECK((row.needs & row.excludes) == 0);
    CHECK((row.needs == 0) == row.instead.empty());
    needed |= row.needs;
    excluded |= row.excludes;
  };
  for (const Choice& choice : choices()) check(choice.name(), choice);
  for (const SettingRow& row : sequence_setting_rows()) check(row.key, row);
  CHECK(needed == excluded);
  CHECK(std::has_single_bit(needed + 1));
}

TEST_CASE("settings of windows select FastABLE; otherwise the filter is the method") {
  CHECK(default_method(Feature::query, std::vector<std::string>{}) == "filter");
  CHECK(default_method(Feature::query, std::vector<std::string>{"margin", "only_sequence"}) ==
        "filter");
  for (const char* key :
       {"c_l", "t_r", "t_r_scale", "safety_factor", "score", "decide", "exclusion_frames"})
    CHECK(default_method(Feature::query, std::vector<std::string>{"margin", key}) == "fastable");
  CHECK(default_method(Feature::loops, std::vector<std::string>{}) == "fastable");
}

TEST_CASE("resolving fills in implied settings") {
  SequenceQuerySettings settings;
  CHECK(ResolvedSettings(settings)->threshold_scale == ThresholdScale::relative);
  settings.method = "filter";
  const ResolvedSettings filter(settings);
  CHECK(filter->window_length == 1);
  CHECK(filter->score == Score::zscore);
  CHECK(filter->decision == Decision::margin);
  CHECK(filter->margin == kFilterMargin);
  CHECK_FALSE(filter->threshold_scale);
  settings = {};
  by_loop(settings);
  const ResolvedSettings loop(settings, {});
  CHECK(loop->exclusion_frames == 10);
  CHECK(loop->threshold_scale == ThresholdScale::bits);
  // A second time changes nothing.
  CHECK(settings_in_force(*ResolvedSettings(*loop, {})) == settings_in_force(*loop));
}
