// Completions for shells, and manual pages.
#pragma once

#include <string>

#include "command_tree.h"

namespace vpr {

/// A script for "bash", "zsh" or "fish", or a page for "man". Throws Error(usage) for another name.
std::string command_text(const CommandEntry& program, const std::string& kind,
                         const std::string& version);

std::string bash_completion(const CommandEntry& program);
std::string zsh_completion(const CommandEntry& program);
std::string fish_completion(const CommandEntry& program);
/// In troff's man macros, section 1.
std::string manual_page(const CommandEntry& program, const std::string& version);

}  // namespace vpr
