// The method `filter`: rows of what the filter over places and rates believes.
#pragma once

#include <optional>
#include <vector>

#include "match/filter_track.h"
#include "match/rows.h"

namespace vpr {

/// A query that is filtered as it comes. Holds for one FrameDistances, of standardized scores.
struct FilteredQuery {
  FilterState filter;
  PathTrack track;
  SecondLook look;
  std::vector<uint16_t> scores;  ///< of the last frame to all training frames
  std::vector<uint32_t> row;     ///< of the last frame: values of all training frames
  std::vector<uint8_t> view;     ///< descriptor of the last frame that was one; empty after a gap
};

/// Throws Error(usage) for settings out of range.
FilteredQuery start_filtered(const FrameDistances& distances, const MatchSettings& settings);

/// Forgets all frames, as behind one that can't be read.
void forget_frames(FilteredQuery& query);

/// Takes the next readable query frame, and writes its row: for every
/// training frame the value of its view (FilterState); the frame where the query is within the best
/// view (path_at) has that value, and the others of that view one more. Of a training frame that
/// can't be read it means nothing. A frame that shows no new view has the row of the last one but
/// for that. There must be a place. Long databases are shared between threads.
PathReport take_frame(FilteredQuery& query, const FrameDistances& distances,
                      const QueryFrame& frame);

/// Every readable query frame has a row (take_frame), of windows of one frame, with its report;
/// smaller values are likelier. The filter starts anew after an unreadable frame. Takes
/// standardized scores only, and no window lengths but 1. Memory: 68 bytes per training view, and 6
/// per training frame.
WindowStage filter_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                         const MatchSettings& settings);

}  // namespace vpr
