// The last views of a path, read again with what has been learned since they were seen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "matching/filter.h"
#include "matching/frame_distances.h"

namespace vpr {

/// No more views of a path are read again.
inline constexpr size_t kRereadViews = 48;

/// What the views of a path say by now.
struct PathReading {
  std::vector<int32_t> supports;  ///< -z at the best places of its views, in scores; oldest first
  uint32_t margin = 0;            ///< how much likelier it is than being nowhere, in scores
};

/// A view of a path, and how far it is from the places around its best one.
struct SeenView {
  size_t best = 0;                ///< cell
  size_t first = 0;               ///< cell
  std::vector<double> distances;  ///< centred, to the cells from `first` on, which are of one run
};

/// The early views of a walk are scored by little more than the training data. What is learned
/// later says more of them, too: standardized scores of a path are found anew, and a filter over
/// its places and being nowhere takes them, from the first view to the last.
struct SecondLook {
  FilterState filter;  ///< its cells are those around the path
  std::deque<SeenView> views;
};

/// `filter`: the one over all places.
SecondLook start_second_look(const FilterState& filter);

/// Takes a view of the path, whose best place is `cell`, and its scores to all training frames.
/// `scale`: what made them.
void see_view(SecondLook& look, const FilterCells& cells, std::span<const uint16_t> scores,
              const std::function<ScoreScale(size_t)>& scale, size_t cell);

/// What the views say if `scale` makes their scores. The margin is that of the likeliest place
/// within near_views of the last best one; views from before a training frame that can't be read
/// add nothing to it. There must be a view. Time O(views * near_views).
PathReading read_again(SecondLook& look, const FilterCells& cells,
                       const std::function<ScoreScale(size_t)>& scale);

}  // namespace vpr
