#include "decide/score_kind.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "match/rows.h"
#include "match/score_kernels.h"

namespace vpr {
namespace {

// The smallest number that is no recognition. `estimate` is off by a rounding at most.
template <class IsRecognition>
uint32_t smallest_without(double estimate, const IsRecognition& is_recognition) {
  constexpr uint32_t kMost = std::numeric_limits<uint32_t>::max();
  if (estimate >= kMost) return kMost;
  auto limit = static_cast<uint32_t>(std::max(estimate, 0.0));
  while (limit > 0 && !is_recognition(limit - 1)) --limit;
  while (limit < kMost && is_recognition(limit)) ++limit;
  return limit;
}

constexpr std::array<std::string_view, 1> kRawSettings = {"safety_factor"};
constexpr std::array<std::string_view, 2> kZScoreSettings = {"score", "zscore"};

int64_t no_offset(size_t) { return 0; }

double distance_a_frame(double sum, size_t window_length) {
  return sum / static_cast<double>(window_length);
}

double deviations_a_frame(double sum, size_t window_length) {
  return sum / (kScoreUnit * static_cast<double>(window_length));
}

// Means of c_l independent distances, and z, spread by 1 / sqrt(c_l). Measured on the corridor
// against itself and on rendered buildings (docs/methods.md).
constexpr double kMarginShare = 0.45;
constexpr double kMarginDeviations = 3;

double least_distance_margin(double typical_distance, size_t window_length) {
  return kMarginShare * typical_distance / std::sqrt(static_cast<double>(window_length));
}

double least_score_margin(double, size_t window_length) {
  return kMarginDeviations / std::sqrt(static_cast<double>(window_length));
}

constexpr ScoreKind kRaw = {.order = ScoreOrder::distance,
                            .measure = "distance",
                            .title = "distance (summed over the window)",
                            .window_symbol = "c_l",
                            .threshold_symbol = "t_r",
                            .frame_unit = "mean distance",
                            .frame_digits = 1,
                            .number_scale = ThresholdScale::relative,
                            .frame_scale = ThresholdScale::bits,
                            .longest_window = kMaxWindowLength,
                            .missing = -1,
                            .needs_statistics = false,
                            .is_offline = false,
                            .settings = kRawSettings,
                            .offset = no_offset,
                            .frame_value = distance_a_frame,
                            .margin_unit = "bits a frame",
                            .most_margin = 65535,
                            .least_margin = least_distance_margin};

constexpr ScoreKind zscore_row(bool is_offline) {
  return {.order = ScoreOrder::distance,
          .measure = "z-score",
          .title = "z-score (1/1024, summed)",
          .window_symbol = "c_l",
          .threshold_symbol = "t_r",
          .frame_unit = "mean z",
          .frame_digits = 2,
          .number_scale = ThresholdScale::mean_z,
          .frame_scale = ThresholdScale::mean_z,
          .longest_window = kMaxScoredWindow,
          .missing = std::numeric_limits<int32_t>::min(),
          .needs_statistics = true,
          .is_offline = is_offline,
          .settings = kZScoreSettings,
          .offset = score_offset,
          .frame_value = deviations_a_frame,
          .margin_unit = "deviations",
          .most_margin = 64,
          .least_margin = least_score_margin};
}

constexpr ScoreKind kProbability = {.order = ScoreOrder::similarity,
                                    .measure = "probability",
                                    .title = "probability",
                                    .window_symbol = "c_w",
                                    .threshold_symbol = "t_p",
                                    .missing = -1};

constexpr std::array<ScoreKind, kEnumNames<Score>.size() + 1> kKinds = {
    kRaw, zscore_row(false), zscore_row(true), kProbability};

}  // namespace

std::span<const ScoreKind> score_kinds() { return kKinds; }

const ScoreKind& score_kind(Score score) { return kKinds[static_cast<size_t>(score)]; }

const ScoreKind& probability_kind() { return kKinds.back(); }

std::span<const std::string_view> score_settings() { return kZScoreSettings; }

uint32_t distance_limit(double threshold, double divisor) {
  assert(std::isfinite(threshold));
  if (!(threshold > 0)) return 0;
  if (divisor == 0) return 1;
  return smallest_without(std::floor(threshold * divisor), [&](uint32_t distance) {
    return static_cast<double>(distance) / divisor < threshold;
  });
}

uint32_t score_limit(double threshold, size_t window_length) {
  assert(std::isfinite(threshold));
  const double estimate = std::floor(threshold * kScoreUnit * static_cast<double>(window_length)) +
                          static_cast<double>(score_offset(window_length));
  return smallest_without(
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

}  // namespace vpr
