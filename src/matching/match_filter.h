// The method `filter`: rows of what the filter over places and rates believes.
#pragma once

#include "matching/rows.h"

namespace vpr {

/// Query frame after query frame, as it comes: every readable frame has a row, of windows of one
/// frame, with a value for every readable training frame (FilterState), that of its view; smaller
/// is likelier. The frame where the query is within the best view (path_at) has that view's value,
/// and the others of it one more. A frame that shows no new view has the row of the last one. The
/// filter starts anew behind a frame that can't be read. Rows arrive in order, from the calling
/// thread. settings.on_path, if set, is told of every row before it arrives. Takes standardized
/// scores only; memory is 60 bytes a training view, and 10 a training frame.
void match_filter(const FrameDistances& distances, const MatchSettings& settings,
                  const Monitor& monitor, const RowConsumer& consume);

}  // namespace vpr
