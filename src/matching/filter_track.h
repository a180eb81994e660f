// When the filter is believed: the best place has to be the end of one path for a while.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "matching/filter.h"
#include "matching/row_kernels.h"

namespace vpr {

/// Which training sequences are walks of one place, [a][b]: none where it is empty.
using SharedPlaces = std::vector<std::vector<uint8_t>>;

/// What is known at a query frame.
struct PathFrame {
  size_t cell = 0;             ///< of the best place; ties: the smallest
  size_t frame = 0;            ///< where in its view, among all training frames
  uint32_t margin = 0;         ///< 0: not to be trusted
  uint32_t nowhere = 0;        ///< the value of being nowhere
  std::optional<double> rate;  ///< training frames a query frame, lately
};

/// The path that the best places of the last views lie on.
struct PathTrack {
  RowKernels kernels;
  SharedPlaces shared;
  bool is_established = false;
  size_t views = 0;              ///< of the query; 0 before the first one
  size_t start = 0;              ///< the cell where it began
  int32_t support = 0;           ///< mean of -z at its places, in scores, weighted 1/2, 1/4, ...
  std::deque<int32_t> supports;  ///< -z at the places of its last views, in scores
  PathFrame last;

  struct Point {
    size_t query_frame = 0;
    size_t train_frame = 0;
  };
  std::deque<Point> recent;  ///< first frames of views that met
};

/// Takes what the filter says of a view that begins at this query frame. The path goes on where
/// the best place is at most near_views from the last one, in the same sequence, and is a new one
/// elsewhere. The margin is the smallest value of a place farther than near_views from the best one
/// in its sequence, of one in a sequence that shows another place, or of being nowhere, less the
/// best value; and 0 unless the path is trusted (FilterSettings).
void follow_view(PathTrack& track, const FilterState& state, std::span<const uint16_t> scores,
                 size_t query_frame);

/// Where the query is at a frame of the last view, if it goes on through the training view at its
/// rate: at most at the view's end. A path of few views is taken to be as fast as the training
/// walk.
PathFrame path_at(const PathTrack& track, const FilterCells& cells, size_t query_frame);

}  // namespace vpr
