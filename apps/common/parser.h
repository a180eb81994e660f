// Commands, flags and --config files of a program. Wraps CLI11, which is expensive to compile: only
// parser.cpp includes it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace vpr {

/// The group of flags without another group. -h lists only these; --help lists all flags.
inline constexpr const char* kEssentialGroup = "Options";
/// The last group of flags in the help, and the sections with a place of their own in manual pages.
inline constexpr const char* kCommonGroup = "Common options";
inline constexpr const char* kExampleSection = "Example";
inline constexpr const char* kExitCodeSection = "Exit codes";

/// A handle of a flag or argument. Each function changes it and returns the handle.
class Flag {
 public:
  explicit Flag(CLI::Option& option) : option_(&option) {}

  Flag required();
  /// The heading of the flag in the help.
  Flag group(const std::string& heading);
  /// Values for completions; the help shows only `word`.
  Flag choices(const std::string& word, const std::vector<std::string>& names);
  /// Reads the value before the values of all later flags, which override it.
  Flag read_first();
  /// The two flags cannot be combined.
  Flag excludes(const Flag& other);
  /// The flag takes `fewest` to `most` values.
  Flag expected(int fewest, int most);
  /// One argument contains several values.
  Flag comma_separated();

 private:
  CLI::Option* option_;
};

/// A handle of a program or of one of its commands. Values of flags must live until the program is
/// parsed.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}

  /// `flag`: "--name", "-n,--name", or "NAME" for an argument without a flag. T is string,
  /// optional<string, uint64_t or double>, or vector<string or uint64_t>. `group`: the heading in
  /// the help. `word`: the name of the value there, as in FILE or text|csv; empty: by T.
  template <class T>
  Flag add_option(const std::string& flag, T& value, const std::string& help,
                  const std::string& group = kEssentialGroup, const std::string& word = "") const;
  /// Passes the text of the value to `read`, which may throw.
  Flag add_option(const std::string& flag, const std::function<void(const std::string&)>& read,
                  const std::string& help, const std::string& group = kEssentialGroup,
                  const std::string& word = "") const;
  Flag add_flag(const std::string& flag, bool& value, const std::string& help,
                const std::string& group = kEssentialGroup) const;
  /// A repeatable flag. Values are not split.
  Flag add_list(const std::string& flag, std::vector<std::string>& values, const std::string& help,
                const std::string& group = kEssentialGroup, const std::string& word = "TEXT") const;
  /// Another name of the command, which the help does not list.
  void add_alias(const std::string& name) const;
  /// Removes a flag, such as --output of a command without output files.
  void remove_flag(const std::string& flag) const;
  /// Inserts a section, a heading with a colon and lines, before the sections at the end of the
  /// help.
  void add_footer(const std::string& text) const;

  /// Whether the command line has the flag.
  bool is_given(const std::string& flag) const;
  /// The values of a flag on the command line.
  std::vector<std::string> values_of(const std::string& flag) const;
  /// The flags of a group on the command line.
  std::vector<std::string> given_flags(const std::string& heading) const;

 private:
  CLI::App* app_;
};

/// A flag or an argument as help, completions and manual pages show it.
struct FlagEntry {
  std::vector<std::string> names;    ///< with dashes, short names first; of an argument only one
  std::string value;                 ///< FILE, NUMBER, a|b|c; empty for a switch
  std::vector<std::string> choices;  ///< values for completions
  std::string help;
  std::string group;
  bool is_required = false;
};

/// A section at the end of the help.
struct Section {
  std::string title;
  std::string text;  ///< preformatted lines
};

struct CommandEntry {
  std::string name;
  std::vector<std::string> aliases;  ///< names that the help does not list
  std::string description;
  std::vector<Section> sections;
  std::vector<FlagEntry> arguments;
  std::vector<FlagEntry> flags;  ///< by group; required flags are first in their group
  std::vector<CommandEntry> commands;
  bool runs_itself = true;  ///< false: a command is required
};

/// A section starts at the beginning or after an empty line, with a title that ends with a colon.
std::vector<Section> split_sections(const std::string& footer);

/// A flag or argument on the command line.
struct GivenFlag {
  std::vector<std::string> names;  ///< long names without dashes; empty for an argument
  std::vector<std::string> values;
};

class Parser {
 public:
  Parser(const std::string& name, const std::string& description, const std::string& version);
  ~Parser();

  /// The program itself.
  Command root() const;
  /// A command with -h, --help and --version. Calls `chosen` if the command line names it.
  Command add_command(const std::string& name, const std::string& description,
                      std::function<void(const Command&)> chosen);
  void require_command(bool required);

  /// Returns false after -h, --help, help or --version, whose text is printed. Throws Error(usage),
  /// and errors from reading values.
  bool parse(int argc, char** argv);
  /// Flags and arguments on the command line: those of the program, then those of its command.
  std::vector<GivenFlag> given() const;
  /// Whether the chosen command has the flag.
  bool takes(const std::string& flag) const;
  /// Omits flags without a group.
  CommandEntry describe() const;

 private:
  std::string version_;
  std::unique_ptr<CLI::App> app_;
};

/// The JSON value of a flag: a number, including ".5", "+1" and "1e-3", or a string.
Json flag_value(const std::string& text);

/// Keys of a configuration file, or the settings and the seed of a result file. Throws Error(input)
/// if the file cannot be read, Error(usage) if it is neither, Error(data) for a damaged result.
Json read_config(const std::string& path);

/// The columns of a line of help, unless a single word is longer.
inline constexpr size_t kHelpWidth = 80;
/// The first column of the help of a flag.
inline constexpr size_t kHelpColumn = 30;

/// The help of a command. `path`: the program and the command, as in "vpr-eval compare". Breaks
/// long lines between words; an example continues after a backslash, so it can be copied.
std::string help_text(const CommandEntry& command, const std::string& path);

/// The help on one screen: commands, essential flags with their help up
/// to the first semicolon, and the first example.
std::string short_help_text(const CommandEntry& command, const std::string& path);

/// A completion script for `kind` "bash", "zsh" or "fish", or a manual page in troff (section 1)
/// for "man". Throws Error(usage) for another kind.
std::string completion_text(const CommandEntry& program, const std::string& kind,
                            const std::string& version);

}  // namespace vpr
