// When the filter is believed: the best place has to be the end of one path for a while.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "match/filter.h"
#include "match/row_kernels.h"

namespace vpr {

/// Which training sequences are walks of one place, [a][b]: none where it is empty.
using SharedPlaces = std::vector<std::vector<uint8_t>>;

/// What a view of the query shows.
struct QueryView {
  size_t frame = 0;   ///< its first one
  double change = 0;  ///< since the last view, in typical distances
  /// What it and the views before it say of its best place; a path begins with it or not.
  std::function<PathReading(size_t cell, bool begins)> read_path;
  /// How much the training walk changes between two places of a sequence, in the same; not set: as
  /// the query.
  std::function<double(size_t from, size_t to)> walked_change;
};

/// What is known at a query frame.
struct PathFrame {
  size_t cell = 0;             ///< of the best place; ties: the smallest
  size_t frame = 0;            ///< where in its view, among all training frames
  uint32_t margin = 0;         ///< 0: not to be trusted
  uint32_t nowhere = 0;        ///< the value of being nowhere
  std::optional<double> rate;  ///< training frames a query frame, lately
  uint32_t track = 0;          ///< number of the confirmed track, from 1 on; 0: not confirmed
};

/// The path that the best places of the last views lie on.
struct PathTrack {
  RowKernels kernels;
  SharedPlaces shared;
  bool is_established = false;
  uint32_t number = 0;  ///< of confirmed tracks so far: rises whenever is_established becomes true
  size_t views = 0;     ///< of the query; 0 before the first one
  size_t start = 0;     ///< the cell where it began
  std::vector<int32_t> supports;  ///< -z at the places of its last views, in scores (PathReading)
  int32_t support = 0;            ///< their mean, weighted 1/2, 1/4, ... into the past
  /// The sum of -z - kUnrelatedSupport at these places, in scores, never below 0; a view adds or
  /// takes kMostEvidence at most.
  int64_t evidence = 0;
  std::deque<uint32_t> margins;  ///< of the views before the last one, trusted or not
  PathFrame last;

  struct Point {
    size_t query_frame = 0;
    size_t train_frame = 0;
  };
  std::deque<Point> recent;  ///< first frames of views that met
};

/// Deviations: what places that only look alike support a path by, and what a view counts for.
inline constexpr double kUnrelatedSupport = 1.25;
inline constexpr double kMostEvidence = 3;

/// How much of the margin and the support will do for a path of twice the length.
inline constexpr double kLongShare = 0.8;

/// What a share of the usual margin counts at most, and what a change by a typical distance more
/// than the training walk's takes from the shares.
inline constexpr double kMostMarginShare = 1.5;
inline constexpr double kChangeWeight = 1.5;

/// Takes what the filter says of a view, which is behind the last one. The path goes on where
/// the best place is at most near_views from the last one, in the same sequence, and is a new one
/// elsewhere. The margin is the smallest value of a place farther than near_views from the best one
/// in its sequence, or of one in a sequence that shows another place, less the best value; but at
/// most that of the path's reading, and 0 unless the path is trusted (FilterSettings).
void follow_view(PathTrack& track, const FilterState& state, const QueryView& view);

/// Where the query is at a frame of the last view, if it goes on through the training view at its
/// rate: at most at the view's end. A path of few views is taken to be as fast as the training
/// walk.
PathFrame path_at(const PathTrack& track, const FilterCells& cells, size_t query_frame);

}  // namespace vpr
