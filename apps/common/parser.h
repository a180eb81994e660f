// A program's parser: commands and flags as flags.h adds them, read back as data; --config files,
// and suggestions for unknown words.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "flags.h"

namespace vpr {

/// Headings that stand apart: flags that all programs share come last.
inline constexpr const char* kCommonGroup = "Common options";
inline constexpr const char* kExampleSection = "Example";
inline constexpr const char* kExitCodeSection = "Exit codes";

struct FlagEntry {
  std::vector<std::string> names;    ///< with dashes, short ones first
  std::string value;                 ///< FILE, NUMBER, a|b|c; empty: takes none
  std::vector<std::string> choices;  ///< values that completions offer
  std::string help;
  std::string group;
  bool is_required = false;
};

struct ArgumentEntry {
  std::string name;
  std::string help;
  bool is_required = false;
};

/// A part of what help ends with: a heading, and lines as they stand.
struct Section {
  std::string title;
  std::string text;
};

struct CommandEntry {
  std::string name;
  std::string description;
  std::vector<Section> sections;
  std::vector<ArgumentEntry> arguments;
  std::vector<FlagEntry> flags;  ///< by group; within one, what is required first
  std::vector<CommandEntry> commands;
  bool runs_itself = true;  ///< false: one of its commands must be named
};

/// Headings end with a colon and stand behind an empty line, or first.
std::vector<Section> split_sections(const std::string& footer);

/// A flag or argument of the command line with what was given for it.
struct GivenFlag {
  std::vector<std::string> names;  ///< long ones, without dashes; none of an argument
  std::vector<std::string> values;
};

class Parser {
 public:
  Parser(const std::string& name, const std::string& description, const std::string& version);
  ~Parser();

  /// The program's own flags.
  Command root() const;
  /// A command with --help and --version; `chosen` is called where it is named.
  Command add_command(const std::string& name, const std::string& description,
                      std::function<void()> chosen);
  /// Whether one of the commands must be named.
  void require_command(bool required);

  /// False if --help or --version were asked for, and were printed. Throws Error(usage), and what
  /// those throw that read values.
  bool parse(int argc, char** argv);
  /// What was given, the program's first, then its command's.
  std::vector<GivenFlag> given() const;
  /// Whether the command that was given has a flag.
  bool takes(const std::string& flag) const;
  /// Hidden flags (without a group) are left out. What stands behind a colon in the name of a
  /// flag's value are its choices.
  CommandEntry describe() const;

 private:
  std::string version_;
  std::unique_ptr<CLI::App> app_;
};

/// The keys of a configuration, or the settings and the seed that a result was made with. Throws
/// Error(input) if it can't be read, Error(usage) if it is neither, Error(data) if it is a damaged
/// result.
Json read_config(const std::string& path);

/// A sentence on the first word that is no flag of the program or of the command that `words` name,
/// or no command where one must be named; with the nearest that there is, if one is near. Nothing
/// if all are known. Says which help to read. `words`: the command line without the program's name.
std::optional<std::string> unknown_word(const CommandEntry& program,
                                        const std::vector<std::string>& words);

}  // namespace vpr
