// Command lines to copy.
#pragma once

#include <string>
#include <vector>

namespace vpr {

/// The command line with `flag` set to `value`, at its end and nowhere else. Arguments that
/// a shell would change are quoted. `command_line` starts with the program.
std::string command_with(const std::vector<std::string>& command_line, const std::string& flag,
                         const std::string& value);

}  // namespace vpr
