// The method `filter`: rows of what the filter over places and rates believes.
#pragma once

#include <span>

#include "match/rows.h"

namespace vpr {

/// Every readable query frame has a row, of windows of one frame, with its report: for every
/// training frame the value of its view (FilterState), smaller values being likelier; the frame
/// where the query is within the best view (path_at) has that value, and the others of that view
/// one more. The value of an unreadable training frame means nothing. A frame that shows no new
/// view has the row of the last one but for that. The filter starts anew after an unreadable frame.
/// Takes standardized scores only, and no window length but 1. Throws Error(usage) for settings out
/// of range. Memory: 68 bytes per training view, and 6 per training frame. Long databases are
/// shared between threads.
WindowStage filter_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                         const MatchSettings& settings);

}  // namespace vpr
