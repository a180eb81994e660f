// FastABLE over a whole query at once: the same distances as frame by frame, two to three times as
// fast, in pieces and in any order.
#pragma once

#include <functional>

#include "match/rows.h"

namespace vpr {

/// Takes pieces of rows of the windows of the length-th window length, as RowConsumer does.
using LengthRowConsumer = std::function<void(size_t length, const ScoreRow&)>;

/// Strips of diagonals (train frame - query frame) are independent: their running sums stay in
/// place, each with a ring of its own of the longest window length, in the thread's own cache.
/// Distances of frames are computed once for all window lengths (at least one). Any tile of
/// `distances` can be asked for at any time; of two sequences one at least has a window.
void match_strips(const FrameDistances& distances, std::span<const size_t> window_lengths,
                  const MatchSettings& settings, const Monitor& monitor,
                  const LengthRowConsumer& consume);

}  // namespace vpr
