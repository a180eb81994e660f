#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace vpr::test {

/// These variables (NAME=VALUE), then those of this process, as posix_spawn takes them.
class Environment {
 public:
  explicit Environment(std::vector<std::string> variables);
  char** data() { return pointers_.data(); }

 private:
  std::vector<std::string> variables_;
  std::vector<char*> pointers_;
};

/// Runs a program's main in a child of a process that has loaded its libraries
/// (faults/server.cpp), which takes most of the time of a short run. `words`: path of the program
/// and its arguments. Returns the status of waitpid; none without the library that is preloaded.
std::optional<int> run_served(const std::vector<std::string>& words,
                              const std::filesystem::path& out, const std::filesystem::path& err);

}  // namespace vpr::test
