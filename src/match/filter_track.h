// The path of the best places, traced back. The window stage of the filter, and the places that
// training sequences pass several times, by the same rule.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "match/filter.h"
#include "match/match.h"

namespace vpr {

/// A keyframe of the query on a path.
struct PathKeyframe {
  size_t frame = 0;  ///< its first frame
  size_t cell = 0;
  uint32_t value = 0;      ///< of the cell
  uint32_t distance = 0;   ///< of the frame to the place when it arrived
  uint32_t path = 0;       ///< number of the path in one pass, from 1 on
  size_t length = 0;       ///< keyframes of the path up to this one
  size_t established = 0;  ///< of them, those since it was established; 0: it was not
};

/// The path that ends at the best place of the last keyframe.
struct PathTrack {
  bool follows_decoys = false;  ///< against the direction of the training sequences
  double typical_distance = 0;  ///< of training frames
  FilterSettings settings;
  std::vector<std::vector<uint8_t>> overlapping;  ///< MatchSettings::overlapping_sequences
  uint32_t paths = 0;                             ///< the largest number of a path
  std::deque<PathKeyframe> recent;  ///< the last keyframes of all paths: path_keyframes * 4 + 1
  uint32_t margin = 0;              ///< 0: the path has fewer than path_keyframes
  size_t first_frame = 0;           ///< the first frame that the path may still recognize
};

/// Adds the filter's state for the next keyframe; distance_to(cell) is its distance to a place. The
/// best place has the smallest value in the direction of the track (ties: the first cell). It
/// continues the path if it is at most near_keyframes from the last place, in the same sequence, or
/// in another pass of the same place: first passes are at most 2 near_keyframes apart (same_place),
/// the places themselves are not. There the path stays in its pass if that has a place near the
/// last one of at most 5 deviations less evidence; otherwise the path gets a new number. If the
/// best place is elsewhere, it is traced back over path_keyframes / 2 keyframes: it resumes the
/// last path with a place that it reaches in the same sense, unless that path is established (once
/// it has a margin of 5 deviations), and otherwise begins a path. A resumed path includes the
/// keyframes since then.
///
/// The path is then traced back over path_keyframes / 2 keyframes: each place is the best one
/// (ties: the first cell) of those from which a step leads to the next. The margin is the smallest
/// value of a runner-up and of a new path, minus the value of the path. Runners-up are all places
/// in both directions, except for those in this direction that are within near_keyframes in this
/// sequence, in sequences of the same place, or in other passes of the same place. It is 0 if less
/// than a quarter of the last path_keyframes advance to a later place, and for a mean distance
/// above 1.05 typical distances. From 0.5 to 0.8 of them, the keyframes that must advance increase
/// to three quarters, and the margin decreases by up to 4 deviations.
///
/// The path may recognize its frames in the last path_keyframes * 3 / 2 + 1 keyframes; until it has
/// been established for as many, in all of `recent`, from the keyframe on at which it begins: it
/// advances by at least 3 places over the next path_keyframes / 2, after the last step of more than
/// kLongestStep and at most near_keyframes places backward, and has at most 3 keyframes at its
/// first place.
void follow_keyframe(PathTrack& track, const FilterState& state, size_t query_frame,
                     const std::function<uint32_t(size_t cell)>& distance_to);

/// The number of recent keyframes of the path; 0 before the first one.
size_t path_size(const PathTrack& track);

/// The number of recent keyframes whose places may still change.
size_t open_keyframes(const PathTrack& track);

/// Training frames per query frame over the last path_keyframes in one pass; nullopt after too few.
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

/// Sets of at most this number of keyframes are followed whole by find_passes.
inline constexpr size_t kExhaustivePlaces = 4096;

/// The training sequences as queries of their own past, one after the other: keyframes at least 32
/// keyframes earlier, and all earlier sequences. A keyframe that the filter recognizes by
/// `least_margin`, in units of PathTrack, is another pass through its match; keyframes between two
/// such ones at most 64 apart are too if their matches fit. Earlier passes do not compete with each
/// other. Increasing by frame. `statistics`: of the training frames, with components.
///
/// With more than `exhaustive_places` keyframes, only those near a similar place are followed: a
/// filter over every fourth keyframe has 6 deviations more evidence for a place than for any
/// reversed one. The 96 keyframes before it and 32 after it are followed as well, as a query of
/// their own. Time: keyframes^2 / 32 distances, and keyframes for each followed one. Memory: two
/// copies of the descriptors of keyframes. The same for any number of threads and any SIMD target.
/// Throws Error(interrupted) on a stop.
std::vector<RepeatedPlace> find_passes(std::span<const DescribedFrames> train,
                                       const TrainStatistics& statistics, uint32_t least_margin,
                                       const Monitor& monitor,
                                       size_t exhaustive_places = kExhaustivePlaces);

}  // namespace vpr
