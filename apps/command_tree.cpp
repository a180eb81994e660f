#include "command_tree.h"

#include <sstream>

#include <CLI/CLI.hpp>

namespace vpr {
namespace {

// "text|csv" is a choice; "NUMBER" is not.
std::vector<std::string> split_choices(const std::string& value) {
  std::vector<std::string> choices;
  if (value.find('|') == std::string::npos) return choices;
  std::istringstream text(value);
  for (std::string choice; std::getline(text, choice, '|');) choices.push_back(choice);
  return choices;
}

FlagEntry describe_flag(const CLI::Option& option) {
  FlagEntry flag;
  for (const std::string& name : option.get_snames()) flag.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) flag.names.push_back("--" + name);
  if (option.get_items_expected_max() > 0) {
    const std::string type = option.get_type_name();  // with its checks behind a colon
    flag.value = type.substr(0, type.find(':'));
    flag.choices = split_choices(flag.value);
  }
  flag.help = option.get_description();
  flag.group = option.get_group();
  return flag;
}

}  // namespace

CommandEntry describe_commands(const CLI::App& app) {
  CommandEntry entry;
  entry.name = app.get_name();
  entry.description = app.get_description();
  entry.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    if (option->nonpositional())
      entry.flags.push_back(describe_flag(*option));
    else
      entry.arguments.push_back({option->get_name(true), option->get_description()});
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    entry.commands.push_back(describe_commands(*command));
  return entry;
}

}  // namespace vpr
