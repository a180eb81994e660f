#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace vpr::test {

/// Runs a program's main in a child of a process that has loaded its libraries
/// (faults/server.cpp), which takes most of the time of a short run. `words`: path of the program
/// and its arguments. Returns the status of waitpid; none without the library that is preloaded.
std::optional<int> run_served(const std::vector<std::string>& words,
                              const std::filesystem::path& out, const std::filesystem::path& err);

}  // namespace vpr::test
