// What --help prints.
#pragma once

#include <cstddef>
#include <string>

#include "parser.h"

namespace vpr {

/// Columns that no line of help exceeds, but for a single word that is longer.
inline constexpr size_t kHelpWidth = 100;
/// Where what a flag means begins.
inline constexpr size_t kHelpColumn = 30;

/// Help on a command. `path`: the words that call it, as in "vpr-eval compare". What is required
/// stands first, what all programs share last; long lines are broken between words, commands of
/// examples with a backslash, so that they can be copied.
std::string help_text(const CommandEntry& command, const std::string& path);

/// Breaks lines that are too long; what goes on is indented by `indent` (for the lines behind the
/// first one of each). No final line feed.
std::string wrapped(const std::string& text, size_t width, size_t indent);

}  // namespace vpr
