#include "decide/decision.h"

#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "decide/result.h"
#include "match/match.h"

namespace vpr {
namespace {

constexpr std::array<std::string_view, 3> kThresholdSettings = {"t_r", "t_r_scale",
                                                                "safety_factor"};
constexpr std::array<std::string_view, 2> kMarginSettings = {"decide", "margin"};

void check_threshold(const SequenceQuerySettings& settings) {
  if (settings.margin)
    throw Error(ErrorKind::usage,
                fmt::format("margin {} decides nothing here; add --decide margin, or leave it out",
                            *settings.margin));
}

void check_margin(const SequenceQuerySettings& settings) {
  if (settings.distance_threshold || settings.threshold_scale || settings.safety_factor)
    throw Error(ErrorKind::usage,
                "t_r, its scale and its safety decide nothing with --decide margin; leave them "
                "out, or take --decide threshold");
  if (!settings.margin) return;
  const double most = score_kind(settings.score).most_margin;
  if (!(*settings.margin >= 0 && *settings.margin <= most))
    throw Error(ErrorKind::usage,
                fmt::format("margin must be auto or from 0 to {} {}, found {}", most,
                            score_kind(settings.score).margin_unit, *settings.margin));
}

bool has_margin(const Result& result, size_t query_window) {
  const auto& wanted = result.targets[result.best[query_window]->target].margin;
  const auto margin = frame_margin(result, query_window);
  return wanted && margin && *margin >= *wanted;
}

constexpr DecisionKind kThreshold = {.summary = "every window pair closer than t_r is a hit",
                                     .hits = "window pairs with a {} below the threshold",
                                     .symbol = "t_r",
                                     .order = ScoreOrder::distance,
                                     .setting = &SequenceQuerySettings::distance_threshold,
                                     .settings = kThresholdSettings,
                                     .check = check_threshold};

constexpr DecisionKind kMargin = {
    .summary = "the best match of a window, if it is --margin better than the best one elsewhere",
    .hits = "best matches with a {} better than the best one elsewhere by at least the margin",
    .symbol = "margin",
    .order = ScoreOrder::similarity,
    .setting = &SequenceQuerySettings::margin,
    .settings = kMarginSettings,
    .check = check_margin,
    .accepts = has_margin};

constexpr std::array<DecisionKind, kEnumNames<Decision>.size()> kKinds = {kThreshold, kMargin};

}  // namespace

std::span<const DecisionKind> decision_kinds() { return kKinds; }

const DecisionKind& decision_kind(Decision decision) {
  return kKinds[static_cast<size_t>(decision)];
}

void check_decision(const SequenceQuerySettings& settings) {
  decision_kind(settings.decision).check(settings);
}

}  // namespace vpr
