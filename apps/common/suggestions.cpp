#include "suggestions.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/text.h"

namespace vpr {
namespace {

// "; did you mean --c-l?", where one begins like the word or is a slip of the hand away; else ".".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const auto longer = std::find_if(known.begin(), known.end(), [&](const std::string& name) {
    return name.size() > word.size() && name.starts_with(word);
  });
  const std::string best = longer == known.end() ? nearest(word, known) : *longer;
  const bool is_near = longer != known.end() ||
                       edit_distance(word, best) <= std::max<size_t>(1, (word.size() - 1) / 3);
  return is_near ? fmt::format("; did you mean {}?", best) : ".";
}

void add_flags(const CommandEntry& command, std::vector<std::string>& known) {
  for (const FlagEntry& flag : command.flags)
    known.insert(known.end(), flag.names.begin(), flag.names.end());
}

bool is_flag(const std::string& word) { return word.size() > 2 && word.starts_with("--"); }

}  // namespace

std::optional<std::string> unknown_word(const CommandEntry& program,
                                        const std::vector<std::string>& words) {
  std::vector<std::string> flags;
  add_flags(program, flags);
  std::vector<std::string> commands;
  for (const CommandEntry& command : program.commands) commands.push_back(command.name);
  std::string path = program.name;
  for (const std::string& word : words) {
    const auto named = std::find(commands.begin(), commands.end(), word);
    if (named != commands.end() && path == program.name) {
      add_flags(program.commands[static_cast<size_t>(named - commands.begin())], flags);
      path += " " + word;
    } else if (&word == &words.front() && !program.runs_itself && !word.starts_with('-')) {
      return fmt::format("unknown command {}{} There are {}", word, did_you_mean(word, commands),
                         fmt::join(commands, ", "));
    }
  }
  if (path == program.name && !program.runs_itself)
    return fmt::format("give a command: {}; see {} --help", fmt::join(commands, ", "), path);
  for (const std::string& word : words) {
    if (word == "--") break;
    const std::string name = word.substr(0, word.find('='));
    if (is_flag(name) && std::find(flags.begin(), flags.end(), name) == flags.end())
      return fmt::format("unknown flag {}{} See {} --help", name, did_you_mean(name, flags), path);
  }
  return std::nullopt;
}

}  // namespace vpr
