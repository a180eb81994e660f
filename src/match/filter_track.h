// Confirmation of tracks: the best place must be the end of one path for some time. The window
// stage of the filter.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "match/filter.h"
#include "match/match.h"

namespace vpr {

/// Which training sequences overlap, [a][b]; empty: none.
using SharedPlaces = std::vector<std::vector<uint8_t>>;

/// A keyframe of the query.
struct QueryKeyframe {
  size_t frame = 0;   ///< its first frame
  double change = 0;  ///< since the last keyframe, in typical distances
  /// Re-scores this keyframe and the previous ones of the path to its best place; `begins`: a new
  /// path.
  std::function<RescoredPath(size_t cell, bool begins)> rescore_path;
  /// The change of the training sequence between two places, in the same unit; not set: the change
  /// of the query.
  std::function<double(size_t from, size_t to)> train_change;
};

/// The state at a query frame.
struct PathFrame {
  size_t cell = 0;             ///< of the best place; ties: the smallest
  size_t frame = 0;            ///< position within its keyframe, in all training frames
  uint32_t margin = 0;         ///< 0: not confirmed
  uint32_t off_map = 0;        ///< the value of the off-map state
  std::optional<double> rate;  ///< recent training frames per query frame
  uint32_t track = 0;          ///< number of the confirmed track, from 1 on; 0: not confirmed
};

/// The path of the best places of the last keyframes.
struct PathTrack {
  RowKernels kernels;
  SharedPlaces shared;
  bool is_confirmed = false;
  /// of confirmed tracks so far: increases whenever is_confirmed becomes true
  uint32_t number = 0;
  size_t views = 0;  ///< of the query; 0 before the first one
  size_t start = 0;  ///< the first cell of the path
  /// -z at the places of its last keyframes, in scores (RescoredPath)
  std::vector<int32_t> supports;
  int32_t support = 0;  ///< their mean, weighted 1/2, 1/4, ... into the past
  /// The sum of -z - kUnrelatedSupport at these places, in scores, never below 0 (the CUSUM
  /// statistic); each keyframe changes it by at most kMostEvidence.
  int64_t evidence = 0;
  std::deque<uint32_t> margins;  ///< of the keyframes before the last one, confirmed or not
  PathFrame last;

  struct Point {
    size_t query_frame = 0;
    size_t train_frame = 0;
  };
  std::deque<Point> recent;  ///< first frames of associated keyframes
};

/// In deviations: the support of a path by places that only appear similar, and the limit per
/// keyframe.
inline constexpr double kUnrelatedSupport = 1.25;
inline constexpr double kMostEvidence = 3;

/// The sufficient share of margin and support for a path of twice the length.
inline constexpr double kLongShare = 0.8;

/// The largest share of the usual margin that counts, and the decrease of the shares per typical
/// distance by which the query changes more than the training sequence.
inline constexpr double kMostMarginShare = 1.5;
inline constexpr double kChangeWeight = 1.5;

/// Adds the filter's state for the next keyframe. The path continues if the best place is at most
/// near_keyframes from the last one, in the same sequence; otherwise a new path begins. The margin
/// is the smallest value of a place outside near_keyframes around the best one in its sequence, or
/// in a sequence of another place, minus the best value; but at most the margin of the path's
/// re-scoring, and 0 unless the path is confirmed (FilterSettings).
void follow_keyframe(PathTrack& track, const FilterState& state, const QueryKeyframe& view);

/// The position of the query at a frame of the last keyframe, if it moves through the training
/// keyframe at its rate, at most to the end of the keyframe. A path with few keyframes is assumed
/// to have the speed of the training sequence.
PathFrame path_at(const PathTrack& track, const FilterCells& cells, size_t query_frame);

/// The method filter. Every readable query frame has a row, of windows of one frame, with its
/// report: for every training frame the value of its keyframe (FilterState), where smaller is
/// likelier; the frame at the query's position within the best keyframe (path_at) has this value,
/// and the other frames of this keyframe one more. The value of an unreadable training frame is
/// unspecified. A frame that is not a keyframe repeats the last row except for this position. The
/// filter restarts after an unreadable frame. Supports only z-scores and a window length of 1.
/// Throws Error(usage) for settings out of range. Memory: 68 bytes per training keyframe, and 6 per
/// training frame. Threads share long databases.
WindowStage filter_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                         const MatchSettings& settings);

}  // namespace vpr
