// Forward declaration of the JSON value; base/json.h has its functions.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace vpr {

/// Keys keep the order in which they were inserted.
using Json = nlohmann::ordered_json;

}  // namespace vpr
