// Commands and their flags, without the parser's headers, which only parser.cpp includes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace vpr {

/// A flag or argument of a command. Copies stand for the same one; every change gives it back.
class Flag {
 public:
  explicit Flag(CLI::Option& option) : option_(&option) {}

  Flag required();
  /// The heading under which help lists it.
  Flag group(const std::string& heading);
  /// What help calls its value: FILE, NUMBER, text|csv.
  Flag type_name(const std::string& word);
  /// Values that completions offer, where they are too many for help, which has `word`.
  Flag choices(const std::string& word, const std::vector<std::string>& names);
  /// Its value is read as soon as it is met: flags that come later win.
  Flag read_first();
  /// A number below 0 is a usage error.
  Flag non_negative();
  /// The two can't be given together.
  Flag excludes(const Flag& other);
  /// From `fewest` to `most` values.
  Flag expected(int fewest, int most);
  /// One value holds several, separated by commas.
  Flag comma_separated();

 private:
  CLI::Option* option_;
};

/// A program or one of its commands. Copies stand for the same one. Values that flags fill must
/// live as long as the program parses.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}

  /// `flag`: "--name", "-n,--name", or "NAME" for an argument without a flag.
  Flag add_option(const std::string& flag, std::string& value, const std::string& help) const;
  Flag add_option(const std::string& flag, std::optional<std::string>& value,
                  const std::string& help) const;
  Flag add_option(const std::string& flag, std::vector<std::string>& values,
                  const std::string& help) const;
  Flag add_option(const std::string& flag, std::vector<uint64_t>& values,
                  const std::string& help) const;
  Flag add_option(const std::string& flag, std::optional<uint64_t>& value,
                  const std::string& help) const;
  Flag add_option(const std::string& flag, std::optional<double>& value,
                  const std::string& help) const;
  /// `read` gets the text as it was given; what it throws ends the program.
  Flag add_option(const std::string& flag, const std::function<void(const std::string&)>& read,
                  const std::string& help) const;
  Flag add_flag(const std::string& flag, bool& value, const std::string& help) const;
  /// A flag that may be given several times; each value stands as it is.
  Flag add_list(const std::string& flag, std::vector<std::string>& values,
                const std::string& help) const;
  /// Puts a section (a heading with a colon, and lines) in front of what help ends with.
  void add_footer(const std::string& text) const;

  /// Whether a flag was given, after parsing.
  bool is_given(const std::string& flag) const;
  /// Names of the flags below a heading that were given, after parsing.
  std::vector<std::string> given_flags(const std::string& heading) const;

 private:
  CLI::App* app_;
};

}  // namespace vpr
