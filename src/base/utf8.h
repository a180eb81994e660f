// Whether bytes are UTF-8 text, as JSON must be.
#pragma once

#include <string>

namespace vpr {

bool is_utf8(const std::string& text);

}  // namespace vpr
