// A training sequence compared with itself: after how many frames it shows another place.
#pragma once

#include <functional>
#include <vector>

#include "base/monitor.h"
#include "describe/descriptor_rows.h"
#include "match/rows.h"
#include "store/sequence_database.h"

namespace vpr {

/// After how many frames a walk shows another place: the smallest k for which frames k apart differ
/// by at least half of what two of its frames differ by on average. From every frame, or 10 000
/// spread over a longer walk. The number of frames where no k is large enough; at least 1.
size_t half_width(const DescriptorSpan& walk, const Monitor& monitor = {});

/// Matches frames of the walk with the whole of it.
using WalkMatcher =
    std::function<void(const FrameDistances& distances, const WholeRowConsumer& consume)>;

/// Window pairs of longer walks are compared for stretches of it only, evenly spread.
inline constexpr size_t kMostOwnPairs = size_t{1} << 31;

/// Rows of the walk against itself, cut to windows that start `gap` frames or more before or behind
/// the row's. Nothing comes where no two windows are that far apart. A walk of more than most_pairs
/// window pairs is compared in stretches of 1000 frames, or two windows, each a query of its own.
void match_far(const DescriptorSpan& walk, size_t window_length, size_t gap,
               const WalkMatcher& match, const WholeRowConsumer& consume,
               size_t most_pairs = kMostOwnPairs);

/// Frames of a walk that are a query of their own.
struct Stretch {
  size_t first = 0;
  size_t count = 0;
  std::vector<size_t> unreadable;  ///< counted from the first

  DescriptorSpan of(const DescriptorSpan& walk) const {
    return {walk.rows.subspan(first, count), unreadable, nullptr,
            walk.words.empty() ? walk.words : walk.words.subspan(first, count)};
  }
};

/// The whole walk, or, where it and `other_frames` make more than most_pairs frame pairs, stretches
/// of 1000 frames or two windows, at least two of them: the first begins and the last ends where
/// the walk does.
std::vector<Stretch> choose_stretches(const DescriptorSpan& walk, size_t other_frames,
                                      size_t window_length, size_t most_pairs);

}  // namespace vpr
