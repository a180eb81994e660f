#include "query/choices.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "match/match.h"
#include "match/zscores.h"

namespace vpr {
namespace {

constexpr double kMostGapSeconds = 1e9;
constexpr std::string_view kUseBits = "Use bits per frame, as in --t-r 200 --t-r-scale bits.";

[[noreturn]] void refuse(std::string_view a, std::string_view b, std::string_view instead) {
  throw Error(ErrorKind::usage, "{} does not go with {}. {}", a, b, instead);
}

void require(bool is_right, const std::string& otherwise) {
  if (!is_right) throw Error(ErrorKind::usage, otherwise);
}

std::string name_of(const Rule& rule) {
  if (windows_of(rule) == nullptr) return "--method " + method_of(rule);
  return fmt::format("--decide {}", enum_name(decision_of(rule)));
}

// "--t-r", "--score zscore"; a key without a flag as in files.
std::string name_of(std::string_view key, const Json& value) {
  const bool is_flag = std::ranges::count(sequence_setting_rows(), key, &SettingRow::key) > 0;
  if (!is_flag) return fmt::format("\"{}\"", key);
  return value.is_string() ? fmt::format("{} {}", flag_of(key), value.get<std::string>())
                           : flag_of(key);
}

std::string_view instead_of(std::string_view key) {
  const auto rows = sequence_setting_rows();
  const auto row = std::ranges::find(rows, key, &SettingRow::key);
  return row == rows.end() ? "Omit it." : row->instead;
}

// Refuses the first given value that the query does not have. "auto" goes with everything.
void refuse_others(const SequenceKeys& keys, std::span<const std::string> given,
                   const SequenceQuerySettings& chosen, QueryCommand command) {
  const Json values = value_to_json(keys);
  const Json used = value_to_json(keys_of(chosen));
  for (const auto& [key, value] : values.items()) {
    if (std::ranges::count(given, key) == 0 || value == "auto" || value == used[key]) continue;
    const bool is_of_loops = key == "descriptor" || key.starts_with("loop");
    refuse(name_of(key, value), is_of_loops ? enum_name(command) : name_of(chosen.rule),
           instead_of(key));
  }
}

void check_command(const SequenceQuerySettings& settings, QueryCommand command) {
  const std::string_view name = enum_name(command);
  const std::string method = "--method " + method_of(settings.rule);
  const WindowSettings* windows = windows_of(settings.rule);
  if (command == QueryCommand::live) {
    if (std::holds_alternative<Lsh>(settings.rule) ||
        (windows != nullptr && windows->method == "openable"))
      refuse(name, method, "Use --method filter, or vpr-query without live.");
    if (limit_of(settings.rule) && scale_of(settings) == ThresholdScale::relative)
      refuse("a relative --t-r", name, kUseBits);
  }
  if (command == QueryCommand::sweep && windows == nullptr)
    refuse(name, method, "Use vpr-query, or --method fastable.");
  if (command != QueryCommand::loops) return;
  if (!settings.only_sequences.empty())
    refuse("--only-sequence", name, instead_of("only_sequence"));
  if (!same_place_of(settings.rule).empty()) refuse("--same-place", name, instead_of("same_place"));
}

void check_windows(const WindowSettings& windows) {
  check_window_length(windows.window_length);
  if (windows.score != Score::zscore) return;
  if (windows.method == "openable")
    refuse("--score zscore", "--method openable", "Use --method fastable, or --score raw.");
  require(windows.window_length <= kMaxScoredWindow,
          fmt::format("c_l must be at most {} with z-scores, found {}", kMaxScoredWindow,
                      windows.window_length));
}

void check_limit(double threshold, ThresholdScale scale) {
  require(std::isfinite(threshold), "t_r must be a finite number or auto");
  if (scale == ThresholdScale::mean_z) {
    require(threshold <= 0,
            fmt::format("t_r {} accepts windows that are farther than the average. Use a mean z "
                        "below 0, as in --t-r -1.5.",
                        threshold));
    return;
  }
  require(threshold >= 0, fmt::format("t_r must not be negative, found {}", threshold));
  require(threshold <= 1 || scale != ThresholdScale::relative,
          fmt::format("t_r {0} accepts everything: it is relative to the largest distance. Use a "
                      "share, as in --t-r 0.6, or for a mean frame distance --t-r {0} --t-r-scale "
                      "bits.",
                      threshold));
}

void check_scale(ThresholdScale scale, Score score) {
  const std::string flag = fmt::format("--t-r-scale {}", enum_name(scale));
  const std::string other = fmt::format("--score {}", enum_name(score));
  const bool is_mean_z = scale == ThresholdScale::mean_z;
  if (is_mean_z == (score == Score::zscore)) return;
  refuse(flag, other,
         is_mean_z ? "Use --score zscore, or the scale relative or bits."
                   : "Omit it, or use --t-r-scale mean-z, as in --t-r -1.5.");
}

void check_margin(double margin, Score score) {
  const ScoreKind& kind = score_kind(score);
  require(margin >= 0 && margin <= kind.most_margin,
          fmt::format("margin must be from 0 to {} {}, found {}", kind.most_margin,
                      kind.margin_unit, margin));
}

void check_factor(const std::optional<double>& factor, const SequenceQuerySettings& settings) {
  if (!factor) return;
  if (!has_automatic_threshold(settings))
    refuse("--safety-factor", "a --t-r that is not auto", instead_of("safety_factor"));
  check_safety_factor(*factor);
}

void check_rule(const Threshold& rule, const SequenceQuerySettings& settings) {
  check_windows(rule.windows);
  const ThresholdScale scale = *scale_of(settings);
  check_scale(scale, rule.windows.score);
  if (settings.past && scale == ThresholdScale::relative)
    refuse("a relative --t-r", enum_name(QueryCommand::loops), kUseBits);
  if (has_automatic_threshold(settings) && rule.windows.score == Score::zscore)
    refuse("an automatic t_r", "--score zscore",
           "Add --decide margin, or a number, as in --t-r -1.5.");
  check_factor(rule.safety_factor, settings);
  if (rule.threshold) check_limit(*rule.threshold, scale);
}

void check_rule(const Margin& rule, const SequenceQuerySettings& settings) {
  check_windows(rule.windows);
  const std::string_view loops = enum_name(QueryCommand::loops);
  if (settings.past && !rule.margin)
    refuse("a default --margin", loops, "Use numbers for --margin and --exclusion-frames.");
  if (settings.past && !exclusion_frames_of(settings))
    refuse("an automatic --exclusion-frames", loops, "Use a number, as in --exclusion-frames 20.");
  if (rule.margin) check_margin(*rule.margin, rule.windows.score);
}

void refuse_past(const SequenceQuerySettings& settings) {
  if (settings.past)
    refuse(name_of(settings.rule), enum_name(QueryCommand::loops), "Use --method fastable.");
}

void check_rule(const Filter& rule, const SequenceQuerySettings& settings) {
  refuse_past(settings);
  check_margin(rule.margin, Score::zscore);
  check_filter(rule.settings);
}

void check_rule(const Lsh& rule, const SequenceQuerySettings& settings) {
  refuse_past(settings);
  check_window_length(rule.window_length);
  check_factor(rule.safety_factor, settings);
  if (rule.threshold) check_limit(*rule.threshold, ThresholdScale::bits);
}

void check_gap(const OwnPast& past) {
  if (const auto* frames = std::get_if<uint64_t>(&past.gap); frames != nullptr) {
    require(*frames > 0,
            "the minimum time between a frame and its match is missing: in frames (--gap 300) or "
            "in seconds (--gap 30s)");
    return;
  }
  const double seconds = std::get<double>(past.gap);
  require(
      seconds > 0 && seconds <= kMostGapSeconds,
      fmt::format("loop_gap_s must be above 0, at most {}, found {}", kMostGapSeconds, seconds));
}

}  // namespace

void refuse_setting(std::string_view key, const Rule& rule) {
  refuse(flag_of(key), name_of(rule), instead_of(key));
}

std::string_view default_method(QueryCommand command, std::span<const std::string> given) {
  if (command == QueryCommand::loops || command == QueryCommand::sweep) return "fastable";
  const bool has_windows = std::ranges::any_of(sequence_setting_rows(), [&](const SettingRow& row) {
    return row.is_for_windows && std::ranges::count(given, row.key) > 0;
  });
  return has_windows ? "fastable" : "filter";
}

SequenceQuerySettings choose_query(SequenceKeys keys, std::span<const std::string> given,
                                   QueryCommand command) {
  const auto is_given = [&](std::string_view key) { return std::ranges::count(given, key) > 0; };
  std::string& method = keys.windows.windows.method;
  if (!is_given("method")) method = default_method(command, given);
  find_sequence_method(method);
  keys.loop = command == QueryCommand::loops;
  require(keys.loop_gap == 0 || keys.loop_gap_s == 0,
          "the gap of a loop is in frames or in seconds. Set loop_gap or loop_gap_s, not both.");
  SequenceQuerySettings settings = query_of(keys);
  refuse_others(keys, given, settings, command);
  if (std::holds_alternative<Lsh>(settings.rule) && limit_of(settings.rule) &&
      !is_given("t_r_scale"))
    refuse("a relative --t-r", name_of(settings.rule), kUseBits);
  check_command(settings, command);
  if (command != QueryCommand::sweep) {
    check_settings(settings);
    return settings;
  }
  set_limit(settings.rule, 0.0);  // as the grid will
  check_settings(settings);
  set_limit(settings.rule, std::nullopt);
  return settings;
}

void check_settings(const SequenceQuerySettings& settings) {
  std::visit([&](const auto& rule) { check_rule(rule, settings); }, settings.rule);
  if (settings.past) check_gap(*settings.past);
  require_range("clustering.eps", static_cast<double>(settings.clustering.eps), 0, kMaxEps);
}

}  // namespace vpr
