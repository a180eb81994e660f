#include "decide/query_settings.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "match/match.h"

namespace vpr {
namespace {

constexpr std::array<std::string_view, 3> kThresholdSettings = {"t_r", "t_r_scale",
                                                                "safety_factor"};
constexpr std::array<std::string_view, 2> kMarginSettings = {"decide", "margin"};

constexpr DecisionKind kThreshold = {.recognitions = "window pairs with a {} below the threshold",
                                     .symbol = "t_r",
                                     .order = ScoreOrder::distance,
                                     .settings = kThresholdSettings};

constexpr DecisionKind kMargin = {
    .recognitions =
        "best matches with a {} better than the best one elsewhere by at least the margin",
    .symbol = "margin",
    .order = ScoreOrder::similarity,
    .settings = kMarginSettings};

constexpr std::array<DecisionKind, kEnumNames<Decision>.size()> kKinds = {kThreshold, kMargin};

// Those of other decisions, and of margins what is not set.
void leave_out_decisions(Json& json, const SequenceQuerySettings& settings) {
  for (size_t d = 0; d < decision_kinds().size(); ++d)
    if (d != static_cast<size_t>(settings.decision))
      for (const std::string_view key : decision_kinds()[d].settings) json.erase(key);
  if (!settings.margin_width) json.erase("margin_width");
  if (settings.same_place.empty()) json.erase("same_place");
}

// Of a walk against its own past, the gap that it has not.
void leave_out_loop(Json& json, const SequenceQuerySettings& settings) {
  if (!settings.loop || settings.loop_gap == 0) json.erase("loop_gap");
  if (!settings.loop || settings.loop_gap != 0) json.erase("loop_gap_s");
  if (settings.loop) return;
  json.erase("loop");
  json.erase("descriptor");
}

Json in_force(SequenceQuerySettings settings) {
  settings.threshold_scale = scale_of(settings);
  Json json = value_to_json(settings);
  leave_out_decisions(json, settings);
  if (!has_paths(settings.method)) json.erase("filter");
  const auto own = score_kind(settings.score).settings;
  for (const std::string_view key : score_settings())
    if (std::find(own.begin(), own.end(), key) == own.end()) json.erase(key);
  if (settings.rates.empty()) json.erase("rates");
  if (!settings.fusion_weight) json.erase("fuse_beta");
  leave_out_loop(json, settings);
  return json;
}

Json in_force(const FabmapQuerySettings& settings) { return value_to_json(settings); }

const ScoreKind& score_of_one(const SequenceQuerySettings& settings) {
  return score_kind(settings.score);
}
const ScoreKind& score_of_one(const FabmapQuerySettings&) { return probability_kind(); }

size_t length_of_one(const SequenceQuerySettings& settings) { return settings.window_length; }
size_t length_of_one(const FabmapQuerySettings&) { return 1; }

}  // namespace

std::span<const DecisionKind> decision_kinds() { return kKinds; }

const DecisionKind& decision_kind(Decision decision) {
  return kKinds[static_cast<size_t>(decision)];
}

void check_window_length(uint64_t window_length) {
  if (window_length < 1 || window_length > kMaxWindowLength)
    throw Error(ErrorKind::usage,
                fmt::format("c_l must be from 1 to {}, found {}", kMaxWindowLength, window_length));
}

void check_safety_factor(double factor) {
  if (!std::isfinite(factor) || factor <= 0)
    throw Error(ErrorKind::usage,
                fmt::format("the safety factor must be above 0, found {}", factor));
}

ThresholdScale scale_of(const SequenceQuerySettings& settings) {
  const ScoreKind& kind = score_kind(settings.score);
  return settings.threshold_scale.value_or(settings.loop ? kind.frame_scale : kind.number_scale);
}

Json settings_in_force(const QuerySettings& settings) {
  return std::visit([](const auto& one) { return in_force(one); }, settings);
}

const std::string& method_of(const QuerySettings& settings) {
  return std::visit([](const auto& one) -> const std::string& { return one.method; }, settings);
}

const ScoreKind& score_of(const QuerySettings& settings) {
  return std::visit([](const auto& one) -> const ScoreKind& { return score_of_one(one); },
                    settings);
}

size_t window_length_of(const QuerySettings& settings) {
  return std::visit([](const auto& one) { return length_of_one(one); }, settings);
}

}  // namespace vpr
