#include "completion.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"

namespace vpr {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

std::vector<std::string> names_of(const std::vector<CommandEntry>& commands) {
  std::vector<std::string> names;
  for (const CommandEntry& command : commands) names.push_back(command.name);
  return names;
}

std::vector<std::string> flag_names(const CommandEntry& command) {
  std::vector<std::string> names;
  for (const FlagEntry& flag : command.flags)
    names.insert(names.end(), flag.names.begin(), flag.names.end());
  return names;
}

/// The program itself and its commands, with the name that a script knows them by.
std::vector<std::pair<std::string, const CommandEntry*>> levels(const CommandEntry& program) {
  std::vector<std::pair<std::string, const CommandEntry*>> all = {{"", &program}};
  for (const CommandEntry& command : program.commands) all.emplace_back(command.name, &command);
  return all;
}

std::string bash_choices(const std::string& level, const CommandEntry& command) {
  std::string cases;
  for (const FlagEntry& flag : command.flags)
    for (const std::string& name : flag.names)
      if (!flag.choices.empty())
        cases += fmt::format("    \"{} {}\") words=\"{}\" ;;\n", level, name,
                             fmt::join(flag.choices, " "));
      else if (!flag.value.empty())
        cases += fmt::format("    \"{} {}\") return ;;\n", level, name);
  return cases;
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
  for (const ArgumentEntry& argument : command.arguments)
    text += fmt::format(".TP\n\\fI{}\\fR\n{}\n", troff(argument.name), troff(argument.help));
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

std::string as_it_stands(const std::string& text) {
  return text.empty() ? "" : ".PP\n.nf\n" + troff(text) + "\n.fi\n";
}

std::string upper_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return static_cast<char>(c >= 'a' && c <= 'z' ? c - 32 : c); });
  return text;
}

std::string main_heading(const std::string& title) {
  return ".SH " + troff(upper_case(title)) + "\n";
}

std::string inner_heading(const std::string& title) { return ".PP\n" + troff(title) + ":\n"; }

/// Of a command: what is neither an example nor the exit codes, each with its heading.
std::string manual_sections(const CommandEntry& command,
                            std::string (*heading)(const std::string& title)) {
  std::string text;
  for (const Section& section : command.sections)
    if (section.title != kExampleSection && section.title != kExitCodeSection)
      text += heading(section.title) + as_it_stands(section.text);
  return text;
}

/// The sections of one title, of the program and its commands.
std::string manual_section(const CommandEntry& program, const std::string& title,
                           const std::string& heading) {
  std::string text;
  for (const auto& [level, command] : levels(program))
    for (const Section& section : command->sections)
      if (section.title == title) text += as_it_stands(section.text);
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
  for (const auto& [level, command] : levels(program)) script += bash_choices(level, *command);
  script += "    *) case \"$command/$current\" in\n";
  for (const auto& [level, command] : levels(program))
    script +=
        fmt::format("      {}/-*) words=\"{}\" ;;\n", level, fmt::join(flag_names(*command), " "));
  if (!program.commands.empty())
    script +=
        fmt::format("      /*) words=\"{}\" ;;\n", fmt::join(names_of(program.commands), " "));
  return script + fmt::format(
                      "    esac ;;\n  esac\n  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- "
                      "\"$current\")\n}}\ncomplete -o default -F {} {}\n",
                      function, program.name);
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
    for (const ArgumentEntry& argument : command->arguments)
      page += fmt::format(fmt::runtime(argument.is_required ? " \\fI{}\\fR" : " [\\fI{}\\fR]"),
                          troff(argument.name));
    page += "\n.br\n";
  }
  page += ".SH OPTIONS\n" + manual_flags(program);
  if (!program.commands.empty()) page += ".SH COMMANDS\n";
  for (const CommandEntry& command : program.commands)
    page += fmt::format(".SS {}\n{}\n", troff(command.name), troff(command.description)) +
            manual_flags(command) + manual_sections(command, inner_heading);
  return page + manual_sections(program, main_heading) +
         manual_section(program, kExampleSection, "EXAMPLES") +
         manual_section(program, kExitCodeSection, "EXIT STATUS");
}

}  // namespace

std::string command_text(const CommandEntry& program, const std::string& kind,
                         const std::string& version) {
  if (kind == "bash") return bash_completion(program);
  if (kind == "man") return manual_page(program, version);
  throw Error(ErrorKind::usage, fmt::format("--completion takes bash or man, found {}", kind));
}

}  // namespace vpr
