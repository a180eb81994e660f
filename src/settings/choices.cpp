#include "settings/choices.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "match/fastable.h"
#include "match/lsh.h"
#include "match/match.h"
#include "match/zscores.h"

namespace vpr {
namespace {

using Settings = SequenceQuerySettings;

bool has(const Features& run, Feature feature) { return std::ranges::count(run, feature) > 0; }

// Neither empty nor zero.
template <class T>
bool is_set(const T& value) {
  if constexpr (requires { value.has_value(); })
    return value.has_value();
  else if constexpr (requires { value.empty(); })
    return !value.empty();
  else
    return value != T{};
}

template <auto kMember>
bool is_set(const Settings& settings, const Features&) {
  return is_set(settings.*kMember);
}

bool is_set(Settings settings, std::string_view key) {
  bool found = false;
  visit_fields(settings, [&](std::string_view name, auto& value) {
    if constexpr (requires {
                    is_set(value);
                    value != value;
                  })
      if (name == key) found = is_set(value);
  });
  return found;
}

template <auto kMember, auto kValue>
bool is(const Settings& settings, const Features&) {
  return settings.*kMember == kValue;
}

bool has_relative_threshold(const Settings& settings, const Features&) {
  return settings.decision == Decision::threshold &&
         scale_of(settings) == ThresholdScale::relative &&
         (settings.distance_threshold || settings.loop);
}

// Without a threshold, loops have best matches only.
bool has_automatic_threshold(const Settings& settings, const Features& run) {
  return settings.decision == Decision::threshold && !settings.distance_threshold &&
         !settings.loop && !has(run, Feature::sweep);
}

constexpr std::array kChoices = {
    Choice{.feature = Feature::loops,
           .excludes = kTrainingDistances | kSequences | kLaterFrames,
           .is_implied = is_set<&Settings::loop>},
    Choice{.flag = "a query without its own past",
           .excludes = kPast,
           .is_implied = is<&Settings::loop, false>},
    Choice{.feature = Feature::fabmap, .excludes = kSeconds | kDescriptor},
    Choice{.feature = Feature::database, .needs = kSequences, .instead = "Omit the database."},
    Choice{.feature = Feature::live,
           .needs = kSingleFrames | kSequences,
           .excludes = kLaterFrames,
           .instead = "Use --method filter, or vpr-query without live."},
    Choice{.feature = Feature::sweep,
           .needs = kWindows | kSequences | kEveryScore,
           .instead = "Use vpr-query, or --method fastable."},

    Choice{.flag = "--method filter",
           .needs = kTrainingDistances,
           .excludes = kThreshold | kRaw | kWindows,
           .instead = "Use --method fastable.",
           .is_implied = [](const Settings& s, const Features&) { return s.method == "filter"; }},
    Choice{.flag = "--method lsh",
           .needs = kTrainingDistances,
           .excludes = kMargin | kZScores | kEveryScore | kSingleFrames,
           .instead = "Use --method fastable.",
           .is_implied = [](const Settings& s, const Features&) { return s.method == kLshMethod; }},
    Choice{.flag = "--method openable",
           .excludes = kZScores | kSingleFrames,
           .is_implied = [](const Settings& s, const Features&) { return s.method == "openable"; }},

    Choice{.feature = Feature::raw_score,
           .needs = kRaw,
           .excludes = kZScores,
           .instead = "Omit it.",
           .is_implied = is<&Settings::score, Score::raw>},
    Choice{.flag = "--score zscore",
           .needs = kZScores,
           .excludes = kRaw,
           .instead = "Use --method fastable, or --score raw.",
           .is_implied = is<&Settings::score, Score::zscore>},
    Choice{.feature = Feature::window_length,
           .needs = kWindows,
           .instead = "Omit it, or use --method fastable."},

    Choice{.feature = Feature::by_threshold,
           .needs = kThreshold,
           .excludes = kMargin,
           .instead = "Use --decide margin.",
           .is_implied = is<&Settings::decision, Decision::threshold>},
    Choice{.flag = "--decide margin",
           .needs = kMargin,
           .excludes = kThreshold,
           .instead = "Use --decide threshold, or --method fastable.",
           .is_implied = is<&Settings::decision, Decision::margin>},
    Choice{.flag = "--t-r auto",
           .needs = kRaw,
           .instead = "Use --decide margin, --method filter or a number, as in --t-r -1.5.",
           .is_implied = has_automatic_threshold},
    Choice{.flag = "--t-r-scale relative",
           .needs = kThreshold | kRaw,
           .instead = "Omit it, or use --t-r-scale mean-z, as in --t-r -1.5.",
           .is_implied = is<&Settings::threshold_scale, ThresholdScale::relative>},
    Choice{.flag = "--t-r-scale bits",
           .needs = kThreshold | kRaw,
           .instead = "Omit it, or use --t-r-scale mean-z, as in --t-r -1.5.",
           .is_implied = is<&Settings::threshold_scale, ThresholdScale::bits>},
    Choice{.flag = "--t-r-scale mean-z",
           .needs = kThreshold | kZScores,
           .instead = "Use --score zscore, or the scale relative or bits.",
           .is_implied = is<&Settings::threshold_scale, ThresholdScale::mean_z>},
    Choice{.flag = "a relative --t-r",
           .needs = kLaterFrames | kEveryScore,
           .instead = "Use bits per frame, as in --t-r 200 --t-r-scale bits.",
           .is_implied = has_relative_threshold},
    Choice{
        .flag = "a default --margin",
        .needs = kTrainingDistances,
        .instead = "Use numbers for --margin and --exclusion-frames.",
        .is_implied = [](const Settings& s,
                         const Features&) { return s.decision == Decision::margin && !s.margin; }},
    Choice{.flag = "an automatic --exclusion-frames",
           .needs = kTrainingDistances,
           .instead = "Use a number, as in --exclusion-frames 20.",
           .is_implied =
               [](const Settings& s, const Features&) {
                 return s.decision == Decision::margin && !s.exclusion_frames;
               }},

    Choice{.feature = Feature::save_matrix, .needs = kEveryScore, .instead = "Omit it."},
    Choice{.flag = "a --gap in seconds",
           .needs = kSeconds,
           .instead = "Use a gap in frames, as in --gap 30.",
           .is_implied = is_set<&Settings::loop_gap_s>},
};

constexpr double kMostGapSeconds = 1e9;

void require(bool is_right, const std::string& otherwise) {
  if (!is_right) throw Error(ErrorKind::usage, otherwise);
}

void check_threshold(const Settings& settings) {
  if (!settings.distance_threshold) return;
  const double threshold = *settings.distance_threshold;
  require(std::isfinite(threshold), "t_r must be a finite number or auto");
  if (score_kind(settings.score).needs_statistics) {
    require(threshold <= 0,
            fmt::format("t_r {} accepts windows that are farther than the average. Use a mean z "
                        "below 0, as in --t-r -1.5.",
                        threshold));
    return;
  }
  require(threshold >= 0, fmt::format("t_r must not be negative, found {}", threshold));
  require(threshold <= 1 || scale_of(settings) != ThresholdScale::relative,
          fmt::format("t_r {0} accepts everything: it is relative to the largest distance. Use a "
                      "share, as in --t-r 0.6, or for a mean frame distance --t-r {0} --t-r-scale "
                      "bits.",
                      threshold));
}

void check_margin(const Settings& settings) {
  if (!settings.margin) return;
  const ScoreKind& kind = score_kind(settings.score);
  require(*settings.margin >= 0 && *settings.margin <= kind.most_margin,
          fmt::format("margin must be from 0 to {} {}, found {}", kind.most_margin,
                      kind.margin_unit, *settings.margin));
}

void check_zscore_window(const Settings& settings) {
  require(settings.window_length <= kMaxScoredWindow,
          fmt::format("c_l must be at most {} with z-scores, found {}", kMaxScoredWindow,
                      settings.window_length));
}

void check_gap(const Settings& settings) {
  const bool has_seconds = settings.loop_gap_s != 0;
  require(settings.loop_gap != 0 || has_seconds,
          "the minimum time between a frame and its match is missing: in frames (--gap 300) or in "
          "seconds (--gap 30s)");
  require(settings.loop_gap == 0 || !has_seconds,
          "the gap of a loop is in frames or in seconds. Set loop_gap or loop_gap_s, not both.");
  require(!has_seconds || (settings.loop_gap_s > 0 && settings.loop_gap_s <= kMostGapSeconds),
          fmt::format("loop_gap_s must be above 0, at most {}, found {}", kMostGapSeconds,
                      settings.loop_gap_s));
}

void check_ranges(const Settings& settings) {
  check_window_length(settings.window_length);
  if (settings.safety_factor) check_safety_factor(*settings.safety_factor);
  check_threshold(settings);
  check_margin(settings);
  if (score_kind(settings.score).needs_statistics) check_zscore_window(settings);
  if (has_paths(settings)) check_filter(settings.filter);
  if (settings.loop) check_gap(settings);
  require_range("clustering.eps", static_cast<double>(settings.clustering.eps), 0, kMaxEps);
}

void fill_implied(Settings& settings) {
  if (settings.loop && !settings.exclusion_frames && settings.loop_gap > 0)
    settings.exclusion_frames = settings.loop_gap;
  if (!has_paths(settings)) return;
  if (settings.score == Score::raw) settings.score = Score::zscore;
  settings.window_length = 1;
  settings.decision = Decision::margin;
  if (!settings.margin) settings.margin = kFilterMargin;
}

}  // namespace

std::span<const Choice> choices() { return kChoices; }

void check_choices(const SequenceQuerySettings& settings, const Features& run) {
  struct Made {
    std::string name;
    uint32_t needs;
    uint32_t excludes;
    std::string_view instead;
  };
  std::vector<Made> made;
  for (const Choice& choice : kChoices)
    if ((choice.feature && has(run, *choice.feature)) ||
        (choice.is_implied && choice.is_implied(settings, run)))
      made.push_back({std::string(choice.name()), choice.needs, choice.excludes, choice.instead});
  for (const SettingRow& row : sequence_setting_rows()) {
    const std::string flag = flag_of(row.key);
    const auto feature = enum_value<Feature>(flag);
    if ((row.needs | row.excludes) != 0 &&
        (is_set(settings, row.key) || (feature && has(run, *feature))))
      made.push_back({flag, row.needs, row.excludes, row.instead});
  }
  for (const Made& a : made)
    for (const Made& b : made)
      if (const uint32_t missing = a.needs & b.excludes)
        throw Error(ErrorKind::usage, "{} does not go with {}, which has no {}. {}", a.name, b.name,
                    kFacetNames[std::countr_zero(missing)], a.instead);
}

void add_given_features(Features& run, const SequenceQuerySettings& settings,
                        std::span<const std::string> given) {
  const auto is_given = [&](const char* key) { return std::ranges::count(given, key) > 0; };
  if (is_given("c_l") && settings.window_length != 1) run.push_back(Feature::window_length);
  if (is_given("score") && settings.score == Score::raw) run.push_back(Feature::raw_score);
  if (is_given("decide") && settings.decision == Decision::threshold)
    run.push_back(Feature::by_threshold);
}

std::string_view default_method(Feature command, std::span<const std::string> given) {
  if (command == Feature::loops) return "fastable";
  const bool has_windows = std::ranges::any_of(sequence_setting_rows(), [&](const SettingRow& row) {
    return row.is_for_windows && std::ranges::count(given, row.key) > 0;
  });
  return has_windows ? "fastable" : "filter";
}

ResolvedSettings::ResolvedSettings(SequenceQuerySettings settings, Features run)
    : settings_(std::move(settings)), run_(std::move(run)) {
  find_sequence_method(settings_.method);
  fill_implied(settings_);
  check_choices(settings_, run_);
  check_ranges(settings_);
  if (settings_.decision == Decision::threshold) settings_.threshold_scale = scale_of(settings_);
}

bool ResolvedSettings::has(Feature feature) const { return vpr::has(run_, feature); }

}  // namespace vpr
