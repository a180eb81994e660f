// The name of a JSON value, for declarations; base/json.h has what can be done with it.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace vpr {

/// Keys keep the order in which they were written.
using Json = nlohmann::ordered_json;

}  // namespace vpr
