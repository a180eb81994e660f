#include "settings/query_settings.h"

#include <cmath>

#include "base/error.h"
#include "base/json.h"
#include "match/lsh.h"
#include "match/match.h"

namespace vpr {
namespace {

constexpr std::array<std::string_view, 3> kThresholdSettings = {"t_r", "t_r_scale",
                                                                "safety_factor"};
constexpr std::array<std::string_view, 1> kMarginSettings = {"margin"};

constexpr std::array<DecisionKind, kEnumNames<Decision>.size()> kDecisionKinds = {
    {{.recognitions = "window pairs with a {} below the threshold",
      .symbol = "t_r",
      .order = ScoreOrder::distance,
      .settings = kThresholdSettings},
     {.recognitions = "best matches with a {} better than the runner-up by at least the margin",
      .symbol = "margin",
      .order = ScoreOrder::similarity,
      .settings = kMarginSettings}}};

Json in_force(SequenceQuerySettings settings) {
  settings.threshold_scale = scale_of(settings);
  Json json = value_to_json(settings);
  const auto erase_unless = [&](bool is_in_force, std::string_view key) {
    if (!is_in_force) json.erase(std::string(key));
  };
  for (size_t d = 0; d < kDecisionKinds.size(); ++d)
    for (const std::string_view key : kDecisionKinds[d].settings)
      erase_unless(d == static_cast<size_t>(settings.decision), key);
  const bool is_filter = has_paths(settings);
  erase_unless(is_filter, "filter");
  erase_unless(!is_filter, "exclusion_frames");
  erase_unless(settings.method == kLshMethod, "lsh");
  erase_unless(settings.loop && settings.loop_gap != 0, "loop_gap");
  erase_unless(settings.loop && settings.loop_gap == 0, "loop_gap_s");
  erase_unless(settings.loop, "descriptor");
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

bool has_paths(const SequenceQuerySettings& settings) {
  return find_sequence_method(settings.method).has_paths;
}

bool has_paths(const QuerySettings& settings) {
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  return sequences != nullptr && has_paths(*sequences);
}

const ScoreKind& score_of(const QuerySettings& settings) {
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  return sequences == nullptr ? probability_kind() : score_kind(sequences->score);
}

size_t window_length_of(const QuerySettings& settings) {
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  return sequences == nullptr ? 1 : sequences->window_length;
}

}  // namespace vpr
