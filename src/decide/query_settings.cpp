#include "decide/query_settings.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "match/lsh.h"
#include "match/match.h"
#include "match/score_kernels.h"

namespace vpr {
namespace {

// The smallest sum that is not a recognition. The error of `estimate` is at most a rounding.
template <class IsRecognition>
uint32_t smallest_refused(double estimate, const IsRecognition& is_recognition) {
  constexpr uint32_t kMost = std::numeric_limits<uint32_t>::max();
  if (estimate >= kMost) return kMost;
  auto limit = static_cast<uint32_t>(std::max(estimate, 0.0));
  while (limit > 0 && !is_recognition(limit - 1)) --limit;
  while (limit < kMost && is_recognition(limit)) ++limit;
  return limit;
}

int64_t no_offset(size_t) { return 0; }

double distance_per_frame(double sum, size_t window_length) {
  return sum / static_cast<double>(window_length);
}

double deviations_per_frame(double sum, size_t window_length) {
  return sum / (kScoreUnit * static_cast<double>(window_length));
}

// The deviation of a mean of c_l independent distances, or z, is proportional to 1 / sqrt(c_l).
// Above every margin between floors that look alike (docs/experiments/margins.md).
constexpr double kMarginShare = 0.75;
constexpr double kMarginDeviations = 5.1;

double default_distance_margin(double typical_distance, size_t window_length) {
  return kMarginShare * typical_distance / std::sqrt(static_cast<double>(window_length));
}

double default_score_margin(double, size_t window_length) {
  return kMarginDeviations / std::sqrt(static_cast<double>(window_length));
}

constexpr ScoreKind kRaw = {.order = ScoreOrder::distance,
                            .measure = "distance",
                            .window_symbol = "c_l",
                            .threshold_symbol = "t_r",
                            .number_scale = ThresholdScale::relative,
                            .frame_scale = ThresholdScale::bits,
                            .longest_window = kMaxWindowLength,
                            .missing = -1,
                            .needs_statistics = false,
                            .is_offline = false,
                            .offset = no_offset,
                            .frame_value = distance_per_frame,
                            .margin_unit = "bits per frame",
                            .most_margin = 65535,
                            .default_margin = default_distance_margin};

constexpr ScoreKind zscore_row(bool is_offline) {
  return {.order = ScoreOrder::distance,
          .measure = "z-score",
          .window_symbol = "c_l",
          .threshold_symbol = "t_r",
          .number_scale = ThresholdScale::mean_z,
          .frame_scale = ThresholdScale::mean_z,
          .longest_window = kMaxScoredWindow,
          .missing = std::numeric_limits<int32_t>::min(),
          .needs_statistics = true,
          .is_offline = is_offline,
          .offset = score_offset,
          .frame_value = deviations_per_frame,
          .margin_unit = "deviations",
          .most_margin = 64,
          .default_margin = default_score_margin};
}

constexpr ScoreKind kProbability = {.order = ScoreOrder::similarity,
                                    .measure = "probability",
                                    .window_symbol = "c_w",
                                    .threshold_symbol = "t_p",
                                    .missing = -1};

constexpr std::array<ScoreKind, kEnumNames<Score>.size() + 1> kScoreKinds = {
    kRaw, zscore_row(false), zscore_row(true), kProbability};

constexpr std::array<std::string_view, 3> kThresholdSettings = {"t_r", "t_r_scale",
                                                                "safety_factor"};
constexpr std::array<std::string_view, 1> kMarginSettings = {"margin"};

constexpr DecisionKind kThreshold = {.recognitions = "window pairs with a {} below the threshold",
                                     .symbol = "t_r",
                                     .order = ScoreOrder::distance,
                                     .settings = kThresholdSettings};

constexpr DecisionKind kMargin = {
    .recognitions = "best matches with a {} better than the runner-up by at least the margin",
    .symbol = "margin",
    .order = ScoreOrder::similarity,
    .settings = kMarginSettings};

constexpr std::array<DecisionKind, kEnumNames<Decision>.size()> kDecisionKinds = {kThreshold,
                                                                                  kMargin};

Json in_force(SequenceQuerySettings settings) {
  settings.threshold_scale = scale_of(settings);
  Json json = value_to_json(settings);
  const auto erase_unless = [&](bool is_in_force, std::string_view key) {
    if (!is_in_force) json.erase(std::string(key));
  };
  for (size_t d = 0; d < kDecisionKinds.size(); ++d)
    for (const std::string_view key : kDecisionKinds[d].settings)
      erase_unless(d == static_cast<size_t>(settings.decision), key);
  const bool is_filter = has_paths(settings.method);
  erase_unless(is_filter, "filter");
  for (const char* key : {"rates", "exclusion_frames"}) erase_unless(!is_filter, key);
  erase_unless(settings.method == kLshMethod, "lsh");
  erase_unless(score_kind(settings.score).needs_statistics, "zscore");
  erase_unless(settings.fusion_weight.has_value(), "fusion_weight");
  erase_unless(settings.loop && settings.loop_gap != 0, "loop_gap");
  erase_unless(settings.loop && settings.loop_gap == 0, "loop_gap_s");
  erase_unless(settings.loop, "descriptor");
  return json;
}

Json in_force(const FabmapQuerySettings& settings) { return value_to_json(settings); }

}  // namespace

std::span<const ScoreKind> score_kinds() { return kScoreKinds; }

const ScoreKind& score_kind(Score score) { return kScoreKinds[static_cast<size_t>(score)]; }

const ScoreKind& probability_kind() { return kScoreKinds.back(); }

uint32_t distance_limit(double threshold, double divisor) {
  assert(std::isfinite(threshold));
  if (!(threshold > 0)) return 0;
  if (divisor == 0) return 1;
  return smallest_refused(std::floor(threshold * divisor), [&](uint32_t distance) {
    return static_cast<double>(distance) / divisor < threshold;
  });
}

uint32_t score_limit(double threshold, size_t window_length) {
  assert(std::isfinite(threshold));
  const double estimate = std::floor(threshold * kScoreUnit * static_cast<double>(window_length)) +
                          static_cast<double>(score_offset(window_length));
  return smallest_refused(
      estimate, [&](uint32_t biased_sum) { return mean_z(biased_sum, window_length) < threshold; });
}

int64_t score_offset(size_t window_length) {
  assert(window_length <= kMaxScoredWindow);
  return static_cast<int64_t>(window_length) * kScoreBias;
}

double mean_z(uint32_t biased_sum, size_t window_length) {
  return static_cast<double>(biased_sum - score_offset(window_length)) /
         (kScoreUnit * static_cast<double>(window_length));
}

std::span<const DecisionKind> decision_kinds() { return kDecisionKinds; }

const DecisionKind& decision_kind(Decision decision) {
  return kDecisionKinds[static_cast<size_t>(decision)];
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
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  return sequences == nullptr ? probability_kind() : score_kind(sequences->score);
}

size_t window_length_of(const QuerySettings& settings) {
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  return sequences == nullptr ? 1 : sequences->window_length;
}

}  // namespace vpr
