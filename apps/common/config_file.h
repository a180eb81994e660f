// The file of --config.
#pragma once

#include <string>

#include "base/json_fwd.h"

namespace vpr {

/// The keys of a configuration, or the settings and the seed that a result was made with. Throws
/// Error(input) if it can't be read, Error(usage) if it is neither, Error(data) if it is a damaged
/// result.
Json read_config(const std::string& path);

}  // namespace vpr
