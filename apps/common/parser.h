// A program's parser: commands and flags as flags.h adds them, read back as data.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "command_tree.h"
#include "flags.h"

namespace vpr {

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

}  // namespace vpr
