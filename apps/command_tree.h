// A program's commands and flags as data, read from its parser: what completions and manual pages
// are written from, so that they can't get stale.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace vpr {

struct FlagEntry {
  std::vector<std::string> names;  ///< with dashes, short ones first
  std::string value;               ///< FILE, NUMBER, a|b|c; empty: takes none
  std::vector<std::string> choices;
  std::string help;
  std::string group;
};

struct ArgumentEntry {
  std::string name;
  std::string help;
};

struct CommandEntry {
  std::string name;
  std::string description;
  std::string footer;
  std::vector<ArgumentEntry> arguments;
  std::vector<FlagEntry> flags;
  std::vector<CommandEntry> commands;
};

/// Hidden flags (without a group) are left out.
CommandEntry describe_commands(const CLI::App& app);

}  // namespace vpr
