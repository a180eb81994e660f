// How close windows of different places come: what automatic t_r follow from.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "database/sequence_database.h"
#include "matching/rows.h"

namespace vpr {

/// One entry a training sequence; none where it has no such windows.
using ClosestTable = std::vector<std::optional<ClosestWindows>>;

/// For each training sequence the window of any other one that is closest to any of its own (paper,
/// section VII-D: two training sequences never show the same place, so whatever is as close as
/// they are is no recognition). Ties: smallest own window, then sequence, then window. None for a
/// single sequence.
ClosestTable find_closest_windows(std::span<const DescriptorSpan> sequences,
                                  const MatchSettings& settings, const Monitor& monitor);

}  // namespace vpr
