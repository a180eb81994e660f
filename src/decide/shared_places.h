// Which training walks show the same place, one wholly or in part what the other shows?
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "base/monitor.h"
#include "decide/margin_scan.h"
#include "match/row_kernels.h"

namespace vpr {

/// Two walks share a place where one leaves a trace in the other: of its windows of 20 frames (or
/// half of the shorter walk), at least a tenth have a best match in the other walk by standardized
/// scores from the whole walk (Score::zscore_offline) with a margin of at least 3 / sqrt(20),
/// as had the window 10 frames before, and the two best matches lie 5 to 15 frames apart, too. (In
/// walks of one place in other light, seasons and at other paces it was a third to nine tenths, in
/// walks of different places at most 1 in 25; floors rendered alike can't be told from one.)
/// `widths`: w of every walk. A longer walk is looked at in stretches of 1000 frames, evenly
/// spread, so that of all pairs of walks no more than most_pairs frame pairs are compared, but at
/// least two stretches of each. Pairs (a, b) with a < b, in
/// rising order. Throws Error(interrupted) on a stop.
std::vector<std::pair<size_t, size_t>> find_shared_places(std::span<const DescriptorSpan> walks,
                                                          const std::vector<uint32_t>& widths,
                                                          const RowKernels& kernels,
                                                          const Monitor& monitor,
                                                          size_t most_pairs = size_t{1} << 32);

}  // namespace vpr
