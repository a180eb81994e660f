// The path of the best places, traced back. The window stage of the filter.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "match/filter.h"
#include "match/match.h"

namespace vpr {

/// A keyframe of the query on a path.
struct PathKeyframe {
  size_t frame = 0;  ///< its first frame
  size_t cell = 0;
  uint32_t value = 0;     ///< of the cell
  uint32_t distance = 0;  ///< of the frame to the best place when it arrived
};

/// The path that ends at the best place of the last keyframe.
struct PathTrack {
  bool follows_decoys = false;  ///< against the direction of the training sequences
  double farthest = 0;          ///< largest mean distance of a path with a margin
  FilterSettings settings;
  RowKernels kernels;
  std::vector<std::vector<uint8_t>> overlapping;  ///< MatchSettings::overlapping_sequences
  uint32_t number = 0;                            ///< of the path, from 1 on
  size_t keyframes = 0;                           ///< of the path; 0 before the first one
  uint32_t margin = 0;                            ///< 0: the path has fewer than path_keyframes
  std::deque<PathKeyframe> recent;  ///< its last keyframes, at most path_keyframes * 3 / 2 + 1
};

/// The best place of the filter's state in the direction of the track: that with the smallest value
/// (ties: the first cell).
size_t best_place(const PathTrack& track, const FilterState& state);

/// Adds the filter's state for the next keyframe, whose distance to the best place is `distance`.
/// The best place continues the path if it is at most near_keyframes from the last place, in the
/// same sequence. The path is then traced back over path_keyframes / 2 keyframes: each place is the
/// best one (ties: the first cell) of those from which a step leads to the next. The margin is the
/// smallest value of a place outside near_keyframes around the best one in its sequence, of a place
/// in a sequence of another place, of any place in the other direction, and of a new path, minus
/// the best value. It is 0 unless the path, over its last path_keyframes, passes path_keyframes / 4
/// places and has a mean distance of at most `farthest`.
void follow_keyframe(PathTrack& track, const FilterState& state, size_t query_frame,
                     uint32_t distance);

/// The number of recent keyframes whose places may still change.
size_t open_keyframes(const PathTrack& track);

/// Training frames per query frame over the last path_keyframes; nullopt after too few keyframes.
std::optional<double> recent_rate(const PathTrack& track, const FilterCells& cells);

/// The training frame of a query frame of this keyframe, among all training frames, if the query
/// moves through the training keyframe at this rate, at most to its end.
size_t position_at(const FilterCells& cells, const PathKeyframe& keyframe, size_t query_frame,
                   double rate);

/// The method filter. Every readable query frame has a row, of windows of one frame, with its
/// report: for every training frame the value of its keyframe (FilterState), where smaller is
/// likelier; the frame at the query's position within the best keyframe (position_at) has this
/// value, and the other frames of this keyframe one more. The value of an unreadable training frame
/// is unspecified. A frame that is not a keyframe repeats the last row except for this position.
/// The filter restarts after an unreadable frame. Supports only z-scores and a window length of 1.
/// Throws Error(usage) for settings out of range. Memory: 136 + 8 (path_keyframes / 2) bytes per
/// training keyframe, and 6 per training frame. Threads share long databases.
WindowStage filter_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                         const MatchSettings& settings);

}  // namespace vpr
