// The method `filter`: rows of values of the filter over places and rates.
#pragma once

#include <span>

#include "match/rows.h"

namespace vpr {

/// Every readable query frame has a row, of windows of one frame, with its report: for every
/// training frame the value of its keyframe (FilterState), where smaller is likelier; the frame at
/// the query's position within the best keyframe (path_at) has this value, and the other frames of
/// this keyframe one more. The value of an unreadable training frame is unspecified. A frame that
/// is not a keyframe repeats the last row except for this position. The filter restarts after an
/// unreadable frame. Supports only z-scores and a window length of 1. Throws Error(usage) for
/// settings out of range. Memory: 68 bytes per training keyframe, and 6 per training frame. Long
/// databases are shared between threads.
WindowStage filter_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                         const MatchSettings& settings);

}  // namespace vpr
