// The table of choices: every refused combination is refused by name, and nothing else is.
#include "decide/choices.h"

#include <bit>
#include <functional>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/json.h"
#include "match/match.h"
#include "support.h"

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
    {"--follow", {}},
    {"--scores", {}},
    {"--loop", by_loop},
    {"vpr-tune fastable", {}},
    {"vpr-tune calibrate", {}},
    {"a FAB-MAP database", {}},
    {"--method filter", [](auto& s) { s.method = "filter"; }},
    {"--method lsh", [](auto& s) { s.method = "lsh"; }},
    {"--method openable", [](auto& s) { s.method = "openable"; }},
    {"--fuse", [](auto& s) { s.fusion_weight = 0.2; }},
    {"--score raw", {}},
    {"--score zscore", [](auto& s) { s.score = Score::zscore; }},
    {"--score zscore-offline", [](auto& s) { s.score = Score::zscore_offline; }},
    {"--rates", [](auto& s) { s.rates = {"1/2"}; }},
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
    {"--query", {}},
    {"--dataset", {}},
    {"--query-npy", {}},
    {"--query-bow", {}},
    {"--fps", {}},
    {"--recorded-fps", {}},
    {"--speed", {}},
    {"--query-times", {}},
    {"--ground-truth", {}},
    {"--output", {}},
    {"--save-matrix", {}},
    {"--verify", {}},
    {"--save-loops", {}},
    {"--frame-times", {}},
    {"a --loop-gap in seconds",
     [](auto& s) {
       s.loop_gap = 0;
       s.loop_gap_s = 3;
     }},
    {"--descriptor", [](auto& s) { s.descriptor = "hog"; }},
    {"--distance", {}},
    {"--similarity", {}},
    {"--train-first", {}},
    {"--missing", {}},
    {"--train-sequence", {}}};

const ChosenFlag& asked(std::string_view flag) {
  const auto found = std::find_if(kChosenFlags.begin(), kChosenFlags.end(),
                                  [&](const ChosenFlag& one) { return one.flag == flag; });
  REQUIRE(found != kChosenFlags.end());
  return *found;
}

/// The error for a combination of flags; empty without an error.
std::string error_of(const std::vector<std::string_view>& flags) {
  SequenceQuerySettings settings;
  RunChoices run;
  for (const std::string_view flag : flags) {
    const ChosenFlag& one = asked(flag);
    if (one.set)
      one.set(settings);
    else
      run.push_back(flag);
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
      {{"--score zscore-offline", "--t-r", "--t-r-scale bits"}, "--t-r-scale bits", "offline"},
      {{"--score zscore"}, "--t-r auto", "--score zscore"},
      {{"--score zscore-offline"}, "--t-r auto", "--score zscore-offline"},
      {{"--score zscore", "--safety-factor", "--t-r"}, "--safety-factor", "zscore"},
      {{"--score zscore", "--method openable"}, "--score zscore", "openable"},
      {{"--margin"}, "--margin", "--decide threshold"},
      {{"--decide margin", "--t-r"}, "--t-r", "--decide margin"},
      {{"--decide margin", "--t-r-scale bits"}, "--t-r-scale bits", "--decide margin"},
      {{"--decide margin", "--t-r-scale relative"}, "--t-r-scale relative", "--decide margin"},
      {{"--decide margin", "--safety-factor"}, "--safety-factor", "--decide margin"},
      // Methods.
      {{"--rates", "--method openable"}, "--rates", "--method openable"},
      {{"--rates", "--method filter"}, "--rates", "--method filter"},
      {{"--rates", "--method lsh"}, "--rates", "--method lsh"},
      {{"--decide margin", "--method lsh"}, "--decide margin", "--method lsh"},
      {{"--score zscore", "--t-r", "--method lsh"}, "zscore", "--method lsh"},
      {{"--t-r", "--method lsh"}, "a relative --t-r", "--method lsh"},
      {{"--save-matrix", "--method lsh"}, "--save-matrix", "--method lsh"},
      {{"--verify", "--method lsh"}, "--verify", "--method lsh"},
      {{"--t-r", "--method filter"}, "--t-r", "--method filter"},
      {{"--t-r-scale mean-z", "--method filter"}, "--t-r-scale mean-z", "--method filter"},
      {{"--safety-factor", "--method filter"}, "--safety-factor", "--method filter"},
      {{"--exclusion-frames", "--method filter"}, "--exclusion-frames", "--method filter"},
      {{"--c-l", "--method filter"}, "--c-l", "--method filter"},
      {{"--score raw", "--method filter"}, "--score raw", "--method filter"},
      {{"--decide threshold", "--method filter"}, "--decide threshold", "--method filter"},
      {{"--verify", "--method filter"}, "--verify", "--method filter"},
      {{"--fuse", "--t-r", "--score raw"}, "--score raw", "--fuse"},
      {{"--fuse", "--t-r", "--method openable"}, "--fuse", "--method openable"},
      {{"--fuse", "--t-r", "--verify"}, "--verify", "--fuse"},
      {{"--rates", "--verify"}, "--verify", "--rates"},
      // A loop query.
      {{"--loop", "DB"}, "DB", "--loop"},
      {{"--loop", "--scores"}, "--loop", "--scores"},
      {{"--loop", "--follow"}, "--follow", "--loop"},
      {{"--loop", "--speed"}, "--speed", "--loop"},
      {{"--loop", "--fps"}, "--fps", "--loop"},
      {{"--loop", "--method filter"}, "--method filter", "--loop"},
      {{"--loop", "--method lsh"}, "--method lsh", "--loop"},
      {{"--loop", "--rates"}, "--rates", "--loop"},
      {{"--loop", "--score zscore-offline"}, "offline", "--loop"},
      {{"--loop", "--fuse"}, "--fuse", "--loop"},
      {{"--loop", "--t-r-scale relative"}, "relative", "--loop"},
      {{"--loop", "--decide margin"}, "--margin auto", "--loop"},
      {{"--loop", "a --loop-gap in seconds", "--decide margin", "--margin"},
       "an automatic --exclusion-frames",
       "--loop"},
      {{"--loop", "--only-sequence"}, "--only-sequence", "--loop"},
      {{"--loop", "--same-place"}, "--same-place", "--loop"},
      {{"--loop", "--verify"}, "--verify", "--loop"},
      {{"--loop", "--frame-times"}, "--frame-times", "a --loop-gap in frames"},
      {{"--loop", "vpr-tune fastable"}, "vpr-tune fastable", "--loop"},
      {{"--loop", "vpr-tune calibrate"}, "vpr-tune calibrate", "--loop"},
      {{"DB", "--save-loops"}, "--save-loops", "without --loop"},
      {{"DB", "--frame-times"}, "--frame-times", "without --loop"},
      {{"DB", "--descriptor"}, "--descriptor", "without --loop"},
      // A matrix of scores.
      {{"--scores", "DB"}, "DB", "--scores"},
      {{"--scores", "--query-npy"}, "--query-npy", "--scores"},
      {{"--scores", "--dataset"}, "--dataset", "--scores"},
      {{"--scores", "--follow"}, "--follow", "--scores"},
      {{"--scores", "--fps"}, "--fps", "--scores"},
      {{"--scores", "--recorded-fps"}, "--recorded-fps", "--scores"},
      {{"--scores", "--fuse"}, "--fuse", "--scores"},
      {{"--scores", "--skip-unreadable"}, "--skip-unreadable", "--scores"},
      {{"--scores", "--method filter"}, "--method filter", "--scores"},
      {{"--scores", "--method lsh"}, "--method lsh", "--scores"},
      {{"--scores", "--decide margin"}, "--margin auto", "--scores"},
      {{"--scores", "--decide margin", "--margin"}, "an automatic --exclusion-frames", "--scores"},
      {{"--scores", "--decide margin", "--exclusion-frames"}, "--margin auto", "--scores"},
      {{"--scores", "--safety-factor"}, "--safety-factor", "--scores"},
      {{"--scores", "--verify"}, "--verify", "--scores"},
      {{"DB", "--distance"}, "--distance", "without --scores"},
      {{"DB", "--similarity"}, "--similarity", "without --scores"},
      {{"DB", "--train-first"}, "--train-first", "without --scores"},
      {{"DB", "--missing"}, "--missing", "without --scores"},
      {{"DB", "--train-sequence"}, "--train-sequence", "without --scores"},
      // Frames as they arrive.
      {{"--follow", "--method openable"}, "--follow", "--method openable"},
      {{"--follow", "--method lsh"}, "--follow", "--method lsh"},
      {{"--follow", "--score zscore-offline"}, "offline", "--follow"},
      {{"--follow", "--rates"}, "--rates", "--follow"},
      {{"--follow", "--t-r"}, "a relative --t-r", "--follow"},
      {{"--follow", "--output"}, "--output", "--follow"},
      {{"--follow", "--save-matrix"}, "--save-matrix", "--follow"},
      {{"--follow", "--ground-truth"}, "--ground-truth", "--follow"},
      {{"--follow", "--verify"}, "--verify", "--follow"},
      {{"--follow", "--query-npy"}, "--query-npy", "--follow"},
      {{"--follow", "--speed"}, "--speed", "--follow"},
      {{"--follow", "--query-times"}, "--query-times", "--follow"},
      // Inputs and outputs.
      {{"--query-npy", "--query"}, "--query", "--query-npy"},
      {{"--query-npy", "--dataset"}, "--dataset", "--query-npy"},
      {{"--ground-truth"}, "--ground-truth", "--save-matrix FILE.png"},
      {{"a FAB-MAP database", "--query-bow", "--query"}, "--query", "--query-bow"},
      {{"a FAB-MAP database", "--query-bow", "--dataset"}, "--dataset", "--query-bow"},
      {{"a FAB-MAP database", "--save-loops"}, "--save-loops", "without --loop"},
      {{"a FAB-MAP database", "--loop", "--frame-times"}, "--frame-times", "FAB-MAP"},
      {{"a FAB-MAP database", "a --loop-gap in seconds"}, "--loop-gap in seconds", "FAB-MAP"},
      {{"a FAB-MAP database", "--loop", "--descriptor"}, "--descriptor", "FAB-MAP"},
      // vpr-tune.
      {{"vpr-tune fastable", "--method filter"}, "vpr-tune fastable", "--method filter"},
      {{"vpr-tune fastable", "--method lsh"}, "vpr-tune fastable", "--method lsh"},
      {{"vpr-tune calibrate", "--method lsh"}, "vpr-tune calibrate", "--method lsh"},
      {{"vpr-tune calibrate"}, "vpr-tune calibrate", "--decide threshold"},
      {{"vpr-tune calibrate", "--decide margin", "--fuse"}, "--fuse", "vpr-tune calibrate"}};
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
      {"--method filter", "--margin", "--same-place", "--only-sequence", "--fuse"},
      {"--method filter", "--follow", "--fps"},
      {"--follow", "--t-r", "--t-r-scale bits", "--skip-unreadable"},
      {"--follow", "--t-r-scale relative"},
      {"--follow", "--decide margin", "--fuse"},
      {"--score zscore", "--t-r", "--t-r-scale mean-z", "--rates", "--fuse"},
      {"--score zscore-offline", "--decide margin", "--margin", "--exclusion-frames"},
      {"--score zscore", "--decide margin", "--verify", "--save-matrix", "--output"},
      {"--safety-factor", "--speed", "--fps", "--query", "--dataset", "--query-times"},
      {"--loop", "--query", "--dataset", "--save-loops", "--descriptor", "--save-matrix"},
      {"--loop", "a --loop-gap in seconds", "--frame-times", "--score zscore", "--t-r"},
      {"--loop", "--decide margin", "--margin", "--method openable"},
      {"--scores", "--query", "--speed", "--train-sequence", "--distance", "--missing"},
      {"--scores", "--score zscore", "--only-sequence", "--same-place", "--rates"},
      {"--scores", "--decide margin", "--margin", "--exclusion-frames", "--similarity"},
      {"vpr-tune fastable", "--score zscore", "--fuse", "--rates", "--t-r"},
      {"vpr-tune fastable", "--decide margin", "--margin"},
      {"vpr-tune calibrate", "--decide margin", "--score zscore", "--method filter"},
      {"a FAB-MAP database", "--loop", "--save-loops"}};
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
  for (const Choice& choice : choices()) {
    INFO(choice.flag);
    CHECK((choice.needs & choice.excludes) == 0);
    CHECK((choice.needs == 0) == choice.instead.empty());
    needed |= choice.needs;
    excluded |= choice.excludes;
  }
  CHECK(needed == excluded);
  CHECK(std::has_single_bit(needed + 1));
}

TEST_CASE("the table knows what each method can do") {
  for (const SequenceMethod& method : sequence_methods()) {
    INFO(method.name);
    SequenceQuerySettings settings;
    settings.method = method.name;
    settings.score = Score::zscore;
    if (!method.has_paths) settings.distance_threshold = -1;
    const auto refused = [&] { return test::error_kind([&] { ResolvedSettings{settings}; }); };
    CHECK(refused().has_value() != method.has_scores);
    settings.score = Score::raw;
    if (!method.has_paths) settings.distance_threshold = 0.5;
    settings.rates = {"1/2"};
    CHECK(refused().has_value() != method.has_rates);
  }
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
  settings.distance_threshold = -1;
  const ResolvedSettings fused(settings, {kDatabaseChoice, "--fuse"});
  CHECK(fused->fusion_weight == kFusionWeight);
  CHECK(fused->score == Score::zscore);
  settings = {};
  by_loop(settings);
  const ResolvedSettings loop(settings, {});
  CHECK(loop->exclusion_frames == 10);
  CHECK(loop->threshold_scale == ThresholdScale::bits);
  // A second time changes nothing.
  CHECK(settings_in_force(*ResolvedSettings(*loop, {})) == settings_in_force(*loop));
}
