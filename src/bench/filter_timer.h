// The filter over places and rates, timed.
#pragma once

#include "base/monitor.h"
#include "bench/matching_timers.h"
#include "matching/standardization.h"

namespace vpr {

/// Of a query frame, online; and how many places there are, and the share of frames that are views.
void time_filter(const MatchingCase& example, const ScoreBasis& basis, const Effort& effort,
                 const Monitor& monitor, BenchRow& row);

}  // namespace vpr
