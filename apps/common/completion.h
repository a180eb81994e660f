// Bash completions and manual pages, from a program's description of its flags.
#pragma once

#include <string>

#include "parser.h"

namespace vpr {

/// A completion script for "bash", or a page in troff's man macros (section 1) for "man". Throws
/// Error(usage) for another `kind`.
std::string command_text(const CommandEntry& program, const std::string& kind,
                         const std::string& version);

}  // namespace vpr
