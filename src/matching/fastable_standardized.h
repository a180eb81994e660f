// FastABLE's recurrence over standardized frame distances.
#pragma once

#include <span>

#include "matching/fastable_batch.h"
#include "matching/fastable_online.h"
#include "matching/standardized_frames.h"

namespace vpr {

/// A query in progress: one frame in, one row of scores out.
struct ScoredFastable {
  StandardizedState frames;
  FastableState sums;
};

/// Throws Error(usage) if the ring does not fit the memory limit: a score that leaves a window is
/// the one that entered it, and what was known then is not known any more; or if the window is
/// longer than kMaxScoredWindow.
FastableState start_scored_sums(const TrainCodes& train, const MatchSettings& settings);

/// As advance_fastable, with biased scores (see score_kernels.h) instead of distances: the row
/// holds sums of window_length of them. Call begin_frame before.
std::span<const uint32_t> advance_scored(ScoredFastable& state, const TrainCodes& train,
                                         const HammingKernels& kernels);

/// A whole query, row after row, for windows of several lengths at once. Rows arrive in order,
/// from the calling thread; the first does not depend on later frames unless the basis is offline.
void match_standardized(const TrainCodes& train, const QueryCodes& query,
                        std::span<const size_t> window_lengths, const ScoreBasis& basis,
                        const MatchSettings& settings, const Monitor& monitor,
                        const LengthRowConsumer& consume);

}  // namespace vpr
