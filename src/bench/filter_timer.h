// The filter over places and rates, timed and checked.
#pragma once

#include "base/monitor.h"
#include "bench/matching_timers.h"
#include "matching/standardization.h"

namespace vpr {

/// Of a query frame, online; and how many places there are, and the share of frames that are views.
void time_filter(const MatchingCase& example, const ScoreBasis& basis, const Effort& effort,
                 const Monitor& monitor, BenchRow& row);

/// Compares values of some frames with those of plain code. Throws Error(expectation) if one
/// differs by more than rounding does.
void check_filter_values(const MatchingCase& example, const ScoreBasis& basis,
                         const Monitor& monitor);

}  // namespace vpr
