#include "query/query_settings.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/json.h"
#include "match/lsh.h"
#include "match/match.h"

namespace vpr {
namespace {

constexpr std::array<DecisionKind, kEnumNames<Decision>.size()> kDecisionKinds = {
    {{.recognitions = "window pairs with a {} below the threshold",
      .symbol = "t_r",
      .order = ScoreOrder::distance},
     {.recognitions = "best matches with a {} better than the runner-up by at least the margin",
      .symbol = "margin",
      .order = ScoreOrder::similarity}}};

constexpr std::array<std::string_view, 4> kNotOfThresholds = {"margin", "lsh", "filter", "witness"};
constexpr std::array<std::string_view, 6> kNotOfMargins = {"t_r", "t_r_scale", "safety_factor",
                                                           "lsh", "filter",    "witness"};
constexpr std::array<std::string_view, 5> kNotOfFilters = {"t_r", "t_r_scale", "safety_factor",
                                                           "lsh", "exclusion_frames"};
constexpr std::array<std::string_view, 5> kNotOfLsh = {"margin", "exclusion_frames", "same_place",
                                                       "filter", "witness"};

constexpr std::string_view kFilterMethod = "filter";

// The keys of a rule, and what it implies for keys that it does not have.
void set_keys(SequenceKeys& keys, const Threshold& rule) { keys.windows = rule; }

void set_keys(SequenceKeys& keys, const Margin& rule) {
  keys.windows.windows = rule.windows;
  keys.decision = Decision::margin;
  keys.margin = rule.margin;
}

void set_keys(SequenceKeys& keys, const Filter& rule) {
  keys.windows.windows = {std::string(kFilterMethod), 1, Score::zscore, {}, rule.same_place};
  keys.decision = Decision::margin;
  keys.margin = rule.margin;
  keys.filter = rule.settings;
  keys.witness = rule.witness;
}

void set_keys(SequenceKeys& keys, const Lsh& rule) {
  keys.windows.windows.method = kLshMethod;
  keys.windows.windows.window_length = rule.window_length;
  keys.windows.threshold = rule.threshold;
  keys.windows.safety_factor = rule.safety_factor;
  keys.lsh = rule.settings;
}

// The keys that a rule does not have in files.
std::span<const std::string_view> foreign_keys(const Rule& rule) {
  const std::array<std::span<const std::string_view>, 4> by_rule = {kNotOfThresholds, kNotOfMargins,
                                                                    kNotOfFilters, kNotOfLsh};
  return by_rule[rule.index()];
}

Json in_force(const SequenceQuerySettings& settings) {
  const SequenceKeys keys = keys_of(settings);
  Json json = value_to_json(keys);
  for (const std::string_view key : foreign_keys(settings.rule)) json.erase(std::string(key));
  if (keys.loop_gap == 0) json.erase("loop_gap");
  if (keys.loop_gap != 0 || !keys.loop) json.erase("loop_gap_s");
  if (!keys.loop) json.erase("descriptor");
  return json;
}

Json in_force(const FabmapQuerySettings& settings) { return value_to_json(settings); }

}  // namespace

const DecisionKind& decision_kind(Decision decision) {
  return kDecisionKinds[static_cast<size_t>(decision)];
}

void check_window_length(uint64_t window_length) {
  require_range("c_l", static_cast<double>(window_length), 1, kMaxWindowLength);
}

void check_safety_factor(double factor) {
  if (!std::isfinite(factor) || factor <= 0)
    throw Error(ErrorKind::usage, "the safety factor must be above 0, found {}", factor);
}

const WindowSettings* windows_of(const Rule& rule) {
  if (const auto* threshold = std::get_if<Threshold>(&rule)) return &threshold->windows;
  const auto* margin = std::get_if<Margin>(&rule);
  return margin == nullptr ? nullptr : &margin->windows;
}

const std::string& method_of(const Rule& rule) {
  static const std::string kFilter(kFilterMethod);
  static const std::string kLsh(kLshMethod);
  if (const WindowSettings* windows = windows_of(rule)) return windows->method;
  return has_paths(rule) ? kFilter : kLsh;
}

uint64_t window_length_of(const Rule& rule) {
  if (const WindowSettings* windows = windows_of(rule)) return windows->window_length;
  return has_paths(rule) ? 1 : std::get<Lsh>(rule).window_length;
}

Score score_of(const Rule& rule) {
  if (const WindowSettings* windows = windows_of(rule)) return windows->score;
  return has_paths(rule) ? Score::zscore : Score::raw;
}

Decision decision_of(const Rule& rule) {
  const bool by_margin = std::holds_alternative<Margin>(rule) || has_paths(rule);
  return by_margin ? Decision::margin : Decision::threshold;
}

std::optional<double> limit_of(const Rule& rule) {
  return std::visit(
      [](const auto& one) -> std::optional<double> {
        if constexpr (requires { one.threshold; })
          return one.threshold;
        else
          return one.margin;
      },
      rule);
}

void set_limit(Rule& rule, std::optional<double> limit) {
  if (auto* threshold = std::get_if<Threshold>(&rule)) threshold->threshold = limit;
  if (auto* margin = std::get_if<Margin>(&rule)) margin->margin = limit;
  if (auto* filter = std::get_if<Filter>(&rule)) filter->margin = limit.value_or(kFilterMargin);
  if (auto* lsh = std::get_if<Lsh>(&rule)) lsh->threshold = limit;
}

const std::vector<std::string>& same_place_of(const Rule& rule) {
  static const std::vector<std::string> kNone;
  if (const WindowSettings* windows = windows_of(rule)) return windows->same_place;
  return has_paths(rule) ? std::get<Filter>(rule).same_place : kNone;
}

bool has_paths(const Rule& rule) { return std::holds_alternative<Filter>(rule); }

bool is_zscore(const Rule& rule) { return score_kind(score_of(rule)).needs_statistics; }

std::optional<ThresholdScale> scale_of(const SequenceQuerySettings& settings) {
  if (decision_of(settings.rule) == Decision::margin) return std::nullopt;
  const auto* windows = std::get_if<Threshold>(&settings.rule);
  if (windows == nullptr) return ThresholdScale::bits;
  const ScoreKind& kind = score_kind(windows->windows.score);
  return windows->scale.value_or(settings.past ? kind.frame_scale : kind.number_scale);
}

bool is_searched(const SequenceQuerySettings& settings, const std::string& sequence) {
  const std::vector<std::string>& only = settings.only_sequences;
  return only.empty() || std::ranges::find(only, sequence) != only.end();
}

std::optional<uint64_t> exclusion_frames_of(const SequenceQuerySettings& settings) {
  const WindowSettings* windows = windows_of(settings.rule);
  if (windows == nullptr) return std::nullopt;
  const auto* gap = settings.past ? std::get_if<uint64_t>(&settings.past->gap) : nullptr;
  if (windows->exclusion_frames || gap == nullptr) return windows->exclusion_frames;
  return *gap;
}

bool has_automatic_threshold(const SequenceQuerySettings& settings) {
  return decision_of(settings.rule) == Decision::threshold && !limit_of(settings.rule) &&
         !settings.past;
}

SequenceKeys keys_of(const SequenceQuerySettings& settings) {
  SequenceKeys keys;
  std::visit([&](const auto& rule) { set_keys(keys, rule); }, settings.rule);
  keys.windows.scale = scale_of(settings);
  keys.windows.windows.exclusion_frames = exclusion_frames_of(settings);
  keys.only_sequences = settings.only_sequences;
  keys.skip_unreadable = settings.skip_unreadable;
  keys.clustering = settings.clustering;
  keys.loop = settings.past.has_value();
  if (!settings.past) return keys;
  if (const auto* frames = std::get_if<uint64_t>(&settings.past->gap)) keys.loop_gap = *frames;
  if (const auto* seconds = std::get_if<double>(&settings.past->gap)) keys.loop_gap_s = *seconds;
  keys.descriptor = settings.past->descriptor;
  return keys;
}

SequenceQuerySettings query_of(const SequenceKeys& keys) {
  const auto& [windows, decision, margin, lsh, filter, witness, only_sequences, skip_unreadable,
               clustering, loop, gap, gap_s, descriptor] = keys;
  SequenceQuerySettings settings{{}, only_sequences, skip_unreadable, clustering, {}};
  if (windows.windows.method == kFilterMethod)
    settings.rule =
        Filter{margin.value_or(kFilterMargin), filter, windows.windows.same_place, witness};
  else if (windows.windows.method == kLshMethod)
    settings.rule =
        Lsh{windows.windows.window_length, windows.threshold, windows.safety_factor, lsh};
  else if (decision == Decision::margin)
    settings.rule = Margin{windows.windows, margin};
  else
    settings.rule = windows;
  if (loop) settings.past.emplace().descriptor = descriptor;
  if (loop && gap_s == 0) settings.past->gap = gap;
  if (loop && gap_s != 0) settings.past->gap = gap_s;
  return settings;
}

Json settings_in_force(const QuerySettings& settings) {
  return std::visit([](const auto& one) { return in_force(one); }, settings);
}

const std::string& method_of(const QuerySettings& settings) {
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  return sequences == nullptr ? std::get<FabmapQuerySettings>(settings).method
                              : method_of(sequences->rule);
}

bool has_paths(const QuerySettings& settings) {
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  return sequences != nullptr && has_paths(sequences->rule);
}

const ScoreKind& score_of(const QuerySettings& settings) {
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  return sequences == nullptr ? probability_kind() : score_kind(score_of(sequences->rule));
}

bool is_loop(const QuerySettings& settings) {
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  return sequences == nullptr ? std::get<FabmapQuerySettings>(settings).loop
                              : sequences->past.has_value();
}

size_t window_length_of(const QuerySettings& settings) {
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  return sequences == nullptr ? 1 : window_length_of(sequences->rule);
}

}  // namespace vpr
