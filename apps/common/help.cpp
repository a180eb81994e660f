#include "help.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"

namespace vpr {
namespace {

// The words of a line go on below each other; `end` closes a line that goes on.
std::string wrapped_line(const std::string& line, size_t width, size_t indent,
                         const std::string& end) {
  std::string text;
  std::string rest = line;
  size_t words = rest.find_first_not_of(' ');  // never broken within the indentation
  while (rest.size() > width && words != std::string::npos) {
    size_t cut = rest.rfind(' ', width - end.size());
    if (cut == std::string::npos || cut < words) cut = rest.find(' ', words);
    const size_t next = cut == std::string::npos ? cut : rest.find_first_not_of(' ', cut);
    if (next == std::string::npos) break;
    text += rest.substr(0, rest.find_last_not_of(' ', cut) + 1) + end + "\n";
    rest = std::string(indent, ' ') + rest.substr(next);
    words = indent;
  }
  return text + rest;
}

template <class Work>
std::string for_each_line(const std::string& text, Work&& work) {
  std::string result;
  for (const std::string_view line : split(text, '\n')) result += work(std::string(line)) + "\n";
  result.pop_back();
  return result;
}

// A name and what it means, side by side or below each other.
std::string entry(const std::string& name, const std::string& help) {
  std::string head = "  " + name;
  std::string text;
  if (head.size() + 2 > kHelpColumn) {
    text = head + "\n";
    head.clear();
  }
  head.resize(kHelpColumn, ' ');
  return text + wrapped(head + help, kHelpWidth, kHelpColumn) + "\n";
}

std::string flag_name(const FlagEntry& flag) {
  return fmt::format("{}{}{}", fmt::join(flag.names, ","), flag.value.empty() ? "" : " ",
                     flag.value);
}

std::string flags_text(const CommandEntry& command) {
  std::string text;
  std::string group;
  for (const FlagEntry& flag : command.flags) {
    if (flag.group != group) text += fmt::format("\n{}:\n", flag.group);
    group = flag.group;
    text += entry(flag_name(flag), flag.help + (flag.is_required ? " (required)" : ""));
  }
  return text;
}

std::string usage_text(const CommandEntry& command, const std::string& path) {
  std::string usage;
  if (command.commands.empty() || command.runs_itself) {
    usage = fmt::format("Usage: {} [OPTIONS]", path);
    for (const ArgumentEntry& argument : command.arguments)
      usage += argument.is_required ? " " + argument.name : fmt::format(" [{}]", argument.name);
    usage += "\n";
  }
  if (!command.commands.empty())
    usage += fmt::format("{}{} COMMAND ...\n", usage.empty() ? "Usage: " : "       ", path);
  return usage;
}

// Commands of an example are broken so that a shell takes both halves; the rest between columns.
std::string section_text(const Section& section) {
  const bool is_example = section.title == kExampleSection;
  return fmt::format("\n{}:\n", section.title) +
         for_each_line(section.text,
                       [&](const std::string& line) {
                         const size_t column = line.find_first_not_of(' ', line.find("  ", 2));
                         const size_t indent =
                             is_example || column == std::string::npos ? 6 : column;
                         return wrapped_line(line, kHelpWidth, indent, is_example ? " \\" : "");
                       }) +
         "\n";
}

}  // namespace

std::string wrapped(const std::string& text, size_t width, size_t indent) {
  return for_each_line(
      text, [&](const std::string& line) { return wrapped_line(line, width, indent, ""); });
}

std::string help_text(const CommandEntry& command, const std::string& path) {
  std::string text = wrapped(command.description, kHelpWidth, 0) + "\n" + usage_text(command, path);
  if (!command.arguments.empty()) text += "\nArguments:\n";
  for (const ArgumentEntry& argument : command.arguments)
    text += entry(argument.name, argument.help);
  if (!command.commands.empty()) text += "\nCommands:\n";
  for (const CommandEntry& inner : command.commands) text += entry(inner.name, inner.description);
  text += flags_text(command);
  for (const Section& section : command.sections) text += section_text(section);
  return text;
}

}  // namespace vpr
