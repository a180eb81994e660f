// How close windows of different places come: what automatic t_r follow from.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "database/sequence_database.h"
#include "matching/rows.h"
#include "matching/standardization.h"

namespace vpr {

/// One entry a training sequence; none where it has no such windows.
using ClosestTable = std::vector<std::optional<ClosestWindows>>;

/// For each training sequence the window of any other one that is closest to any of its own (paper,
/// section VII-D: two training sequences never show the same place, so whatever is as close as
/// they are is no recognition). Ties: smallest own window, then sequence, then window. Of a single
/// sequence: closest_elsewhere.
///
/// With a `basis`, which is of all sequences together, every sequence is a query against all others
/// and has the standardized scores that a query would have. Unlike distances, these are not the
/// same in both directions: those with the sequence as training data count.
/// ClosestWindows::score is then a biased sum (matching/score_kernels.h).
ClosestTable find_closest_windows(std::span<const DescriptorSpan> sequences,
                                  const ScoreBasis* basis, const MatchSettings& settings,
                                  const Monitor& monitor);

}  // namespace vpr
