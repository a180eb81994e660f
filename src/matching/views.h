// Views: stretches of frames that look alike, so that a stop counts as what it is, one observation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "descriptors/descriptor_rows.h"

namespace vpr {

/// The frames that start a new view, rising; the first frame always does. A frame is a new view if
/// it differs from the last views as standardized scores define it (is_new_view), with the default
/// settings: from each of the last five by at least a quarter of `typical_distance`. Unreadable
/// frames belong to the view before them. No frames give no views.
std::vector<uint32_t> view_starts(const DescriptorSpan& sequence, double typical_distance);

}  // namespace vpr
