// A walk compared with itself: what looks most like here, but is elsewhere?
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "base/monitor.h"
#include "database/sequence_database.h"
#include "matching/rows.h"

namespace vpr {

/// After how many frames a walk shows another place: the smallest k for which frames k apart differ
/// by at least half of what two of its frames differ by on average. From every frame, or 10 000
/// spread over a longer walk. The number of frames where no k is large enough; at least 1.
size_t half_width(const DescriptorSpan& walk, const Monitor& monitor = {});

/// Matches frames of the walk with the whole of it, as RowConsumer says.
using WalkMatcher =
    std::function<void(const FrameDistances& distances, const RowConsumer& consume)>;

/// Window pairs of longer walks are compared for stretches of it only, evenly spread.
inline constexpr size_t kMostOwnPairs = size_t{1} << 31;

/// Rows of the walk against itself, cut to windows that start `gap` frames or more before or behind
/// the row's. Nothing comes where no two windows are that far apart. A walk of more than most_pairs
/// window pairs is compared in stretches of 1000 frames, or two windows, each a query of its own.
void match_far(const DescriptorSpan& walk, size_t window_length, size_t gap,
               const WalkMatcher& match, const RowConsumer& consume,
               size_t most_pairs = kMostOwnPairs);

/// How far the place of a window reaches: after how many frames, towards the beginning of the walk
/// and its end, windows show another one.
struct PlaceReach {
  size_t before = 0;
  size_t behind = 0;

  bool operator==(const PlaceReach&) const = default;
};

/// Of every window: the fewest frames after which a window differs from it by at least half of what
/// two frames of the walk differ by on average, but no fewer than half_width. Where the walk stops
/// or is slow, a place reaches further than elsewhere. The number of frames where no window is
/// different enough, or none was found among most_pairs pairs of frames, the nearest ones. Windows
/// with a frame that can't be read are passed over, and have no reach of their own.
std::vector<PlaceReach> place_reaches(const DescriptorSpan& walk, size_t window_length,
                                      const Monitor& monitor = {},
                                      size_t most_pairs = size_t{1} << 28);

/// The two windows of the walk that are closest to each other, of those that show different places:
/// the other one starts more than twice as far from the first as that one's place reaches, so that
/// two places of this size have room. Ties: the smallest first window, then the smallest other one.
/// None where no two windows are that far apart. ClosestWindows::other_sequence is 0. Nothing of
/// size n x n is kept; long walks are compared in stretches, as match_far says.
std::optional<ClosestWindows> closest_elsewhere(const DescriptorSpan& walk, size_t window_length,
                                                const RowKernels& kernels, const WalkMatcher& match,
                                                const Monitor& monitor,
                                                size_t most_pairs = kMostOwnPairs);

}  // namespace vpr
