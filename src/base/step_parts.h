// Steps that work through several things one after the other.
#pragma once

#include <cstddef>
#include <string>

#include "base/monitor.h"

namespace vpr {

/// For the work on the thing `index` (from 0) of `count`: what is reported as "match" arrives at
/// `monitor` as "match NAME 3/14" ("match NAME" if there is one thing only), and as a share of the
/// whole step, whose parts are taken to be of one size. Parts may have parts.
Monitor part_of(const Monitor& monitor, const std::string& name, size_t index, size_t count);

}  // namespace vpr
