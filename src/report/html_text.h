// Text, bytes and data inside an HTML page, whatever they hold.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

#include "base/json_fwd.h"

namespace vpr {

/// A text for element content and quoted attributes: & < > " ' become references; bytes that are
/// not UTF-8 and control characters become U+FFFD.
std::string html_escaped(std::string_view text);

/// Bytes as base64 (RFC 4648), padded.
std::string base64(std::span<const std::byte> bytes);

/// A JSON for a script element of type application/json: nothing in it can end the element.
std::string script_json(const Json& json);

/// Replaces every {{name}} by its part, once: what is put in is not looked through again. Every
/// name in the page must have a part.
std::string fill_page(std::string_view page, const std::map<std::string, std::string>& parts);

}  // namespace vpr
