// Settings of the filter over places and rates (filter.h).
#pragma once

#include <cstdint>

#include "base/json_fwd.h"

namespace vpr {

struct FilterSettings {
  /// A frame that differs from the last keyframe by at least this share of the typical distance is
  /// a keyframe, in the query and in training sequences; the filter steps from keyframe to
  /// keyframe.
  double keyframe_change = 0.15;
  double sharpness = 0.5;     ///< log-likelihood per deviation
  double unmatched = -0.5;    ///< the z with equal likelihood off the map and at its training frame
  double jump = 0.001;        ///< probability of a jump to any place, per keyframe
  double enter = 0.01;        ///< probability to leave the map, per keyframe
  double leave = 0.05;        ///< probability to return to any place of the map, per keyframe
  double rate_change = 0.05;  ///< probability of another rate, per keyframe
  uint64_t near_keyframes = 10;  ///< exclusion zone around the best keyframe, in training keyframes
  /// A track is confirmed once it was the best one for confirm_keyframes keyframes (the mean of
  /// those of the query and those of the training sequence that it passed) and has had
  /// confirm_margin and support; or once its evidence reached confirm_evidence (PathTrack) and it
  /// has had confirm_margin. While it continues, it is then accepted wherever it has
  /// confirm_margin. A track of twice as many keyframes is accepted once it has had kLongShare of
  /// both, and then at any margin.
  uint64_t confirm_keyframes = 18;
  double confirm_margin = 8;     ///< in deviations
  double confirm_evidence = 16;  ///< in deviations
  double support = 1.5;          ///< minimum mean of -z at the best places of 24 keyframes
  /// Minimum sum of shares: the shares of a path's support that its last keyframes have, weighted
  /// 1/2, 1/4, ..., and the last one's share of its margin, minus the excess of the query's change
  /// over the training sequence's.
  double present_support = 1.1;
};

VPR_FIELDS(FilterSettings, keyframe_change, sharpness, unmatched, jump, enter, leave, rate_change,
           near_keyframes, confirm_keyframes, confirm_margin, confirm_evidence, support,
           present_support)

/// Throws Error(usage) for settings out of range.
void check_filter(const FilterSettings& settings);

}  // namespace vpr
