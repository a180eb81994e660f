// FastABLE over a whole query at once: the same distances as online, two to three times as fast.
#pragma once

#include "match/rows.h"

namespace vpr {

/// Strips of diagonals (train frame - query frame) are independent: their running sums stay in
/// place, each with a ring of its own of window_length rows, in the thread's own cache. A row
/// therefore arrives in pieces. Nothing is produced where a sequence is shorter than a window.
/// Distances that come in order, and windows of settings.rates, go through fastable_stage.
void match_fastable(const FrameDistances& distances, const MatchSettings& settings,
                    const Monitor& monitor, const RowConsumer& consume);

/// The same for several window lengths in one pass: distances of frames are computed once.
/// settings.window_length does not matter.
void match_fastable_lengths(const FrameDistances& distances, std::span<const size_t> window_lengths,
                            const MatchSettings& settings, const Monitor& monitor,
                            const LengthRowConsumer& consume);

}  // namespace vpr
