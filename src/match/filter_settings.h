// Settings of the filter over places and rates (filter.h).
#pragma once

#include <cstdint>

#include "base/json_fwd.h"

namespace vpr {

struct FilterSettings {
  /// Weight of the training statistics in z-scores, in keyframes, in place of
  /// ZScoreSettings::start_weight: paths soon have more to learn from.
  double start_weight = 2;
  /// A frame that differs from the last keyframe by at least this share of the typical distance is
  /// a keyframe, in the query and in training sequences; the filter steps from keyframe to
  /// keyframe.
  double keyframe_change = 0.15;
  uint64_t near_keyframes = 10;  ///< exclusion zone around the best keyframe, in training keyframes
  /// Minimum length of a recognized path, in query keyframes. It recognizes frames that are half to
  /// one and a half times as many keyframes old, and at its beginning up to four times.
  uint64_t path_keyframes = 16;
};

VPR_FIELDS(FilterSettings, start_weight, keyframe_change, near_keyframes, path_keyframes)

/// Throws Error(usage) for settings out of range.
void check_filter(const FilterSettings& settings);

}  // namespace vpr
