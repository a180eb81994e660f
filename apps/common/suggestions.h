// What the user may have meant.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command_tree.h"

namespace vpr {

/// A sentence on the first word that is no flag of the program or of the command that `words` name,
/// or no command where one must be named; with the nearest that there is, if one is near. Nothing
/// if all are known. Says which help to read. `words`: the command line without the program's name.
std::optional<std::string> unknown_word(const CommandEntry& program,
                                        const std::vector<std::string>& words);

}  // namespace vpr
