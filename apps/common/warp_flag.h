// --warp, for every program that takes a query.
#pragma once

#include <string>

#include "flags.h"

namespace vpr {

/// Adds the flag, and what it takes to the help's end. `about`: what is replayed, and what for.
Flag add_warp_flag(const Command& command, std::string& warp,
                   const std::string& about =
                       "replay the query so, with --seed (below); the "
                       "ground truth stays that of the query as it is");

}  // namespace vpr
