#include "command_tree.h"

#include <algorithm>
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
    const std::string type = option.get_type_name();  // choices and checks stand behind a colon
    const size_t colon = type.find(':');
    flag.value = type.substr(0, colon);
    flag.choices = split_choices(colon == std::string::npos ? flag.value : type.substr(colon + 1));
  }
  flag.help = option.get_description();
  flag.group = option.get_group();
  flag.is_required = option.get_required();
  return flag;
}

// Groups in the order in which they first come, the common one last.
void sort_flags(std::vector<FlagEntry>& flags) {
  std::vector<std::string> groups;
  for (const FlagEntry& flag : flags)
    if (flag.group != kCommonGroup &&
        std::find(groups.begin(), groups.end(), flag.group) == groups.end())
      groups.push_back(flag.group);
  const auto rank = [&](const FlagEntry& flag) {
    const auto group = std::find(groups.begin(), groups.end(), flag.group) - groups.begin();
    return std::pair(group, !flag.is_required);
  };
  std::stable_sort(flags.begin(), flags.end(),
                   [&](const FlagEntry& a, const FlagEntry& b) { return rank(a) < rank(b); });
}

}  // namespace

std::vector<Section> split_sections(const std::string& footer) {
  std::vector<Section> sections;
  std::istringstream text(footer);
  bool is_start = true;
  for (std::string line; std::getline(text, line); is_start = line.empty()) {
    if (is_start && line.ends_with(':') && !line.starts_with(' '))
      sections.push_back({line.substr(0, line.size() - 1), ""});
    else if (!sections.empty())
      sections.back().text += line + "\n";
  }
  for (Section& section : sections) section.text.erase(section.text.find_last_not_of('\n') + 1);
  return sections;
}

CommandEntry describe_commands(const CLI::App& app) {
  CommandEntry entry;
  entry.name = app.get_name();
  entry.description = app.get_description();
  entry.sections = split_sections(app.get_footer());
  entry.runs_itself = app.get_require_subcommand_min() == 0;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    if (option->nonpositional())
      entry.flags.push_back(describe_flag(*option));
    else
      entry.arguments.push_back(
          {option->get_name(true), option->get_description(), option->get_required()});
  }
  sort_flags(entry.flags);
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    entry.commands.push_back(describe_commands(*command));
  return entry;
}

}  // namespace vpr
