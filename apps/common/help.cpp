// Texts about a program: --help, completions for shells and manual pages.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/named_table.h"
#include "base/text.h"
#include "parser.h"

namespace vpr {
namespace {

template <class Work>
std::string for_each_line(const std::string& text, Work&& work) {
  std::string result;
  for (const std::string_view line : split(text, '\n')) result += work(std::string(line)) + "\n";
  result.pop_back();
  return result;
}

std::string wrapped(const std::string& text, size_t width, size_t indent) {
  return for_each_line(
      text, [&](const std::string& line) { return wrapped_line(line, width, indent, ""); });
}

// A name and its help, on one line if the name is short.
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

std::string flag_title(const FlagEntry& flag) {
  return fmt::format("{}{}{}", fmt::join(flag.names, ","), flag.value.empty() ? "" : " ",
                     flag.value);
}

std::string flags_text(const CommandEntry& command) {
  std::string text;
  std::string group;
  for (const FlagEntry& flag : command.flags) {
    if (flag.group != group) text += fmt::format("\n{}:\n", flag.group);
    group = flag.group;
    text += entry(flag_title(flag), flag.help + (flag.is_required ? " (required)" : ""));
  }
  return text;
}

std::string usage_text(const CommandEntry& command, const std::string& path) {
  std::string usage;
  if (command.commands.empty() || command.runs_itself) {
    usage = fmt::format("Usage: {} [OPTIONS]", path);
    for (const FlagEntry& argument : command.arguments)
      usage += argument.is_required ? " " + argument.names.front()
                                    : fmt::format(" [{}]", argument.names.front());
    usage += "\n";
  }
  if (!command.commands.empty())
    usage += fmt::format("{}{} COMMAND ...\n", usage.empty() ? "Usage: " : "       ", path);
  return usage;
}

// A broken command of an example ends with a backslash. Other lines keep their columns.
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

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

// The program, with an empty name, and its commands.
std::vector<std::pair<std::string, const CommandEntry*>> levels(const CommandEntry& program) {
  std::vector<std::pair<std::string, const CommandEntry*>> all = {{"", &program}};
  for (const CommandEntry& command : program.commands) all.emplace_back(command.name, &command);
  return all;
}

std::string troff(const std::string& text) {
  std::string escaped = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  std::string safe;
  for (size_t i = 0; i < escaped.size(); ++i) {
    const bool is_line_start = i == 0 || escaped[i - 1] == '\n';
    if (is_line_start && (escaped[i] == '.' || escaped[i] == '\'')) safe += "\\&";
    safe += escaped[i];
  }
  return safe;
}

std::string manual_flags(const CommandEntry& command) {
  std::string text;
  for (const FlagEntry& argument : command.arguments)
    text +=
        fmt::format(".TP\n\\fI{}\\fR\n{}\n", troff(argument.names.front()), troff(argument.help));
  std::string group = "Options";
  for (const FlagEntry& flag : command.flags) {
    if (flag.group != group) text += fmt::format(".PP\n{}:\n", troff(flag.group));
    group = flag.group;
    std::vector<std::string> names;
    for (const std::string& name : flag.names) names.push_back("\\fB" + troff(name) + "\\fR");
    text += fmt::format(".TP\n{}{}\n{}\n", fmt::join(names, ", "),
                        flag.value.empty() ? "" : " \\fI" + troff(flag.value) + "\\fR",
                        troff(flag.help + (flag.is_required ? " (required)" : "")));
  }
  return text;
}

std::string preformatted(const std::string& text) {
  return text.empty() ? "" : ".PP\n.nf\n" + troff(text) + "\n.fi\n";
}

std::string upper_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return static_cast<char>(c >= 'a' && c <= 'z' ? c - 32 : c); });
  return text;
}

// All sections of a command except the example and the exit codes. `heading`: a format string.
std::string manual_sections(const CommandEntry& command, const char* heading, bool is_upper) {
  std::string text;
  for (const Section& section : command.sections)
    if (section.title != kExampleSection && section.title != kExitCodeSection)
      text += fmt::format(fmt::runtime(heading),
                          troff(is_upper ? upper_case(section.title) : section.title)) +
              preformatted(section.text);
  return text;
}

// The sections with this title of the program and its commands.
std::string manual_section(const CommandEntry& program, const std::string& title,
                           const std::string& heading) {
  std::string text;
  for (const auto& [level, command] : levels(program))
    for (const Section& section : command->sections)
      if (section.title == title) text += preformatted(section.text);
  return text.empty() ? "" : fmt::format(".SH {}\n{}", heading, text);
}

std::string bash_completion(const CommandEntry& program) {
  const std::string function = "_" + replaced(program.name, "-", "_");
  std::string script = fmt::format(
      "# bash completion for {0}\n{1}() {{\n  local current=${{COMP_WORDS[COMP_CWORD]}} "
      "previous=${{COMP_WORDS[COMP_CWORD-1]}} command= words= word\n  COMPREPLY=()\n",
      program.name, function);
  if (!program.commands.empty())  // finds the command among the words before the cursor
    script += fmt::format(
        "  for word in \"${{COMP_WORDS[@]:1:COMP_CWORD-1}}\"; do\n    case \"$word\" in\n"
        "      {}) command=$word; break ;;\n    esac\n  done\n",
        fmt::join(names_of(program.commands), "|"));
  script += "  case \"$command $previous\" in\n";
  std::string flags;
  for (const auto& [level, command] : levels(program)) {
    std::vector<std::string> names;
    for (const FlagEntry& flag : command->flags)
      for (const std::string& name : flag.names) {
        names.push_back(name);
        if (!flag.choices.empty())
          script += fmt::format("    \"{} {}\") words=\"{}\" ;;\n", level, name,
                                fmt::join(flag.choices, " "));
        else if (!flag.value.empty())
          script += fmt::format("    \"{} {}\") return ;;\n", level, name);
      }
    flags += fmt::format("      {}/-*) words=\"{}\" ;;\n", level, fmt::join(names, " "));
  }
  script += "    *) case \"$command/$current\" in\n" + flags;
  if (!program.commands.empty())
    script +=
        fmt::format("      /*) words=\"{}\" ;;\n", fmt::join(names_of(program.commands), " "));
  return script + fmt::format(
                      "    esac ;;\n  esac\n  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- "
                      "\"$current\")\n}}\ncomplete -o default -F {} {}\n",
                      function, program.name);
}

// The help up to the first semicolon, in single quotes; characters of `special` have a backslash.
std::string quoted_summary(const std::string& help, const std::string& special = "") {
  std::string text;
  for (const char letter : help.substr(0, help.find(';')))
    text += letter == '\''                              ? std::string("'\\''")
            : special.find(letter) != std::string::npos ? fmt::format("\\{}", letter)
                                                        : std::string(1, letter);
  return text;
}

// "'*--method[matching method]:METHOD:(filter fastable)'" for each name of the flag.
std::string zsh_flag(const FlagEntry& flag) {
  std::string value;
  if (!flag.choices.empty())
    value = fmt::format(":{}:({})", flag.names.back(), fmt::join(flag.choices, " "));
  else if (!flag.value.empty())
    value = fmt::format(":{}:_files", flag.names.back());
  std::string words;
  for (const std::string& name : flag.names)
    words += fmt::format(" \\\n        '{}{}[{}]{}'", value.empty() ? "" : "*", name,
                         quoted_summary(flag.help, "[]"), value);
  return words;
}

std::string zsh_completion(const CommandEntry& program) {
  const std::string function = "_" + replaced(program.name, "-", "_");
  const std::string commands = fmt::format("{}", fmt::join(names_of(program.commands), " "));
  std::string script =
      fmt::format("#compdef {}\n{}() {{\n  local command= word\n", program.name, function);
  if (!commands.empty())
    script += fmt::format(
        "  for word in ${{words[2,CURRENT-1]}}; do\n    case $word in\n      {}) command=$word; "
        "break ;;\n    esac\n  done\n",
        replaced(commands, " ", "|"));
  script += "  case $command in\n";
  for (const auto& [level, command] : levels(program)) {
    script += fmt::format("    '{}') _arguments", level);
    for (const FlagEntry& flag : command->flags) script += zsh_flag(flag);
    script += level.empty() && !commands.empty()
                  ? fmt::format(" \\\n        '*: :{{compadd {}; _files}}' ;;\n", commands)
                  : " \\\n        '*: :_files' ;;\n";
  }
  return script + fmt::format("  esac\n}}\n{} \"$@\"\n", function);
}

std::string fish_completion(const CommandEntry& program) {
  const std::string commands = fmt::format("{}", fmt::join(names_of(program.commands), " "));
  std::string script;
  for (const auto& [level, command] : levels(program)) {
    const std::string condition =
        !level.empty()      ? fmt::format(" -n '__fish_seen_subcommand_from {}'", level)
        : !commands.empty() ? fmt::format(" -n 'not __fish_seen_subcommand_from {}'", commands)
                            : "";
    const std::string start = fmt::format("complete -c {}{}", program.name, condition);
    for (const FlagEntry& flag : command->flags) {
      script += start;
      for (const std::string& name : flag.names)
        script += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!flag.choices.empty())
        script += fmt::format(" -x -a '{}'", fmt::join(flag.choices, " "));
      else if (!flag.value.empty())
        script += " -r";
      script += fmt::format(" -d '{}'\n", quoted_summary(flag.help));
    }
    if (level.empty())
      for (const CommandEntry& inner : command->commands)
        script +=
            fmt::format("{} -a {} -d '{}'\n", start, inner.name, quoted_summary(inner.description));
  }
  return script;
}

std::string manual_page(const CommandEntry& program, const std::string& version) {
  std::string description = program.description;
  if (description.ends_with('.')) description.pop_back();
  std::string page = fmt::format(
      ".TH {} 1 \"\" \"vpr-toolkit {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n",
      troff(upper_case(program.name)), version, troff(program.name), troff(description));
  for (const auto& [level, command] : levels(program)) {
    if (level.empty() && program.arguments.empty() && !program.commands.empty()) continue;
    page += fmt::format("\\fB{}{}\\fR [\\fIOPTIONS\\fR]", troff(program.name),
                        level.empty() ? "" : " " + troff(level));
    for (const FlagEntry& argument : command->arguments)
      page += fmt::format(fmt::runtime(argument.is_required ? " \\fI{}\\fR" : " [\\fI{}\\fR]"),
                          troff(argument.names.front()));
    page += "\n.br\n";
  }
  page += ".SH OPTIONS\n" + manual_flags(program);
  if (!program.commands.empty()) page += ".SH COMMANDS\n";
  for (const CommandEntry& command : program.commands)
    page += fmt::format(".SS {}\n{}\n", troff(command.name), troff(command.description)) +
            manual_flags(command) + manual_sections(command, ".PP\n{}:\n", false);
  return page + manual_sections(program, ".SH {}\n", true) +
         manual_section(program, kExampleSection, "EXAMPLES") +
         manual_section(program, kExitCodeSection, "EXIT STATUS");
}

}  // namespace

std::string help_text(const CommandEntry& command, const std::string& path) {
  std::string text = wrapped(command.description, kHelpWidth, 0) + "\n" + usage_text(command, path);
  if (!command.arguments.empty()) text += "\nArguments:\n";
  for (const FlagEntry& argument : command.arguments)
    text += entry(argument.names.front(), argument.help);
  if (!command.commands.empty()) text += "\nCommands:\n";
  for (const CommandEntry& inner : command.commands) text += entry(inner.name, inner.description);
  text += flags_text(command);
  for (const Section& section : command.sections) text += section_text(section);
  return text;
}

std::string short_help_text(const CommandEntry& command, const std::string& path) {
  const auto short_entry = [](const std::string& name, const std::string& help) {
    return entry(name, help.substr(0, help.find(';')));
  };
  std::string text = wrapped(command.description, kHelpWidth, 0) + "\n" + usage_text(command, path);
  const bool has_essentials =
      !command.arguments.empty() ||
      std::ranges::count(command.flags, kEssentialGroup, &FlagEntry::group) > 0;
  if (has_essentials) text += "\n";
  for (const FlagEntry& argument : command.arguments)
    text += short_entry(argument.names.front(), argument.help);
  for (const FlagEntry& flag : command.flags)
    if (flag.group == kEssentialGroup) text += short_entry(flag_title(flag), flag.help);
  if (!command.commands.empty()) text += "\nCommands:\n";
  for (const CommandEntry& inner : command.commands)
    text += short_entry(inner.name, inner.description.substr(0, inner.description.find('.')));
  for (const Section& section : command.sections)
    if (section.title == kExampleSection)
      text += section_text({section.title, section.text.substr(0, section.text.find("\n  "))});
  return text + fmt::format("\nAll options: {} --help\n", path);
}

std::string completion_text(const CommandEntry& program, const std::string& kind,
                            const std::string& version) {
  if (kind == "bash") return bash_completion(program);
  if (kind == "zsh") return zsh_completion(program);
  if (kind == "fish") return fish_completion(program);
  if (kind == "man") return manual_page(program, version);
  throw Error(ErrorKind::usage, "--completion takes bash, zsh, fish or man, found {}", kind);
}

}  // namespace vpr
