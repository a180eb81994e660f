// The command line that a user gave, with other values, to be copied into a shell.
#pragma once

#include <string>
#include <vector>

namespace vpr {

/// `words` without the flags in `dropped` (each with its value, as "--t-r 0.5" or "--t-r=0.5") and
/// with `added` behind them, quoted where a shell needs it.
std::string repeated_command(const std::vector<std::string>& words,
                             const std::vector<std::string>& dropped,
                             const std::vector<std::string>& added);

}  // namespace vpr
