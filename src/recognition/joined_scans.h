// What several processes found in their windows, put together as if one had seen all of them.
#pragma once

#include <vector>

#include "base/share.h"
#include "recognition/row_scan.h"

namespace vpr {

/// Steps of all processes. `own`: what this one found, each window by one process only.

/// The largest values of all, in each process.
std::vector<uint32_t> joined_maxima(const Share& share, const std::vector<uint32_t>& own);

/// All hits and best matches, in the first process; others give theirs away. Throws Error(usage)
/// where the hits are more than max_hits.
HitScanResult joined_hits(const Share& share, HitScanResult own, size_t max_hits);

}  // namespace vpr
