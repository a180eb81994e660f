// Text in UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace vpr {

/// Whether bytes are UTF-8, as JSON must be.
bool is_utf8(const std::string& text);

/// The text behind the byte order mark that some editors put in front of it.
std::string_view without_byte_order_mark(std::string_view text);

}  // namespace vpr
