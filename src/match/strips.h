// FastABLE over a whole query at once: the same distances as frame by frame, two to three times as
// fast, in pieces and in any order.
#pragma once

#include <functional>

#include "match/rows.h"

namespace vpr {

/// Receives pieces of rows of windows of the length-th window length, like RowConsumer.
using LengthRowConsumer = std::function<void(size_t length, const ScoreRow&)>;

/// Strips of diagonals (train frame - query frame) are independent: their running sums stay in
/// place, each with its own ring of the longest window length, in the thread's own cache. Distances
/// of frames are computed once for all window lengths (at least one). Any tile of `distances` must
/// be computable at any time; at least one of the two sequences has a window.
void match_strips(const FrameDistances& distances, std::span<const size_t> window_lengths,
                  const MatchSettings& settings, const Monitor& monitor,
                  const LengthRowConsumer& consume);

}  // namespace vpr
