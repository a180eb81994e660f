// A program and its commands: common flags, configuration files, outputs, signals, exit codes.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/monitor.h"
#include "base/output.h"
#include "parser.h"
#include "query/run_info.h"
#include "query/setting_rows.h"
#include "recordings/frames.h"

namespace vpr {

class ProgressLine;

template <class T>
inline constexpr bool kIsEnumField = std::is_enum_v<T>;
template <class T>
inline constexpr bool kIsEnumField<std::optional<T>> = std::is_enum_v<T>;

/// The name of a field's value in the help: the names of an enum, NUMBER or VALUE.
template <class T>
std::string value_name() {
  if constexpr (detail::kIsOptional<T>)
    return value_name<typename T::value_type>();
  else if constexpr (std::is_enum_v<T>)
    return fmt::format("{}", fmt::join(kEnumNames<T>, "|"));
  else
    return std::is_arithmetic_v<T> ? "NUMBER" : "VALUE";
}

/// A flag that sets one field of a settings struct, with the same checks as a configuration file.
template <class T>
Flag add_setting(const Command& command, const std::string& flag, T& field, const std::string& help,
                 const std::string& group = kEssentialGroup,
                 const std::string& word = value_name<T>()) {
  return command.add_option(
      flag,
      [&field, flag](const std::string& text) {
        const bool is_text = std::is_same_v<T, std::string> || kIsEnumField<T>;
        value_from_json(is_text ? Json(text) : flag_value(text), field, "command line", flag);
      },
      help, group, word);
}

/// The flag of a row. Its help has the default in place of {}.
template <class T>
void add_row(const Command& command, const SettingRow& row, T& field) {
  Json initial = value_to_json(field);
  const std::string standard = initial.is_string() ? initial.get<std::string>() : initial.dump();
  const std::string help = fmt::format(fmt::runtime(row.help), standard);
  const std::string group = row.group == nullptr ? kEssentialGroup : row.group;
  const std::string word(row.value);
  const auto added = [&] {
    if constexpr (std::is_same_v<T, bool>)
      return command.add_flag(flag_of(row.key), field, help, group);
    else if constexpr (std::is_same_v<T, std::vector<std::string>>)
      return command.add_list(flag_of(row.key), field, help, group, word.empty() ? "TEXT" : word);
    else
      return add_setting(command, flag_of(row.key), field, help, group,
                         word.empty() ? value_name<T>() : word);
  };
  Flag flag = added();
  if (row.choices != nullptr) flag.choices(std::string(row.value), row.choices());
}

/// Adds the flags of the settings that belong to the command.
template <class S>
void add_settings(const Command& command, S& settings, std::span<const SettingRow> rows,
                  QueryCommand name) {
  for (const SettingRow& row : rows) {
    if ((row.commands & in(name)) == 0) continue;
    visit_fields(settings, [&](std::string_view key, auto& field, const auto&...) {
      if constexpr (!Settings<std::remove_reference_t<decltype(field)>>)
        if (key == row.key) add_row(command, row, field);
    });
  }
}

struct CommonOptions {
  std::string output;
  std::string config;
  std::vector<std::string> config_keys;  ///< the keys of the configuration file
  ProcessSettings process;
  bool quiet = false;
  bool verbose = false;
  bool force = false;
  bool json = false;
};

/// The settings of a command together with the common options, as one JSON object.
template <class S>
struct ConfigKeys {
  S& settings;
  ProcessSettings& process;
};
template <class S, class Visitor>
void visit_fields(ConfigKeys<S>& keys, Visitor&& visit) {
  visit_fields(keys.settings, visit);
  visit_fields(keys.process, visit);
}

/// Claims a folder for charts. Throws Error(usage) for the name of an image or a page.
void claim_charts(Outputs& outputs, const std::string& folder);

/// The environment of a command while it runs.
struct Session {
  const CommonOptions& options;
  Command command;  ///< the chosen one, for its flags on the command line
  const Monitor& monitor;
  RunInfo run;
  ProgressLine& progress;
  Outputs& outputs;

  /// Claims the file of --output, then those other files and the folder of plots that have a name.
  void claim_output(const std::vector<std::string>& files = {},
                    const std::string& plots = "") const;
  /// Writes the file of --output, if any.
  void write_output(const Json& json) const;
  /// Prints a JSON value as one line on stdout. Throws Error(output) if that fails.
  void print_line(const Json& json) const;
  /// Whether print_result prints texts: neither --json nor --quiet is set.
  bool prints_text() const { return !options.json && !options.quiet; }
  /// Commits the outputs, then prints the text to stdout, or the JSON with --json. Advice takes
  /// longer, and is computed after the text is printed. With --quiet, omits both. Throws
  /// Error(output) if printing fails; for a text after written files, warns instead.
  void print_result(const std::string& text, const Json& json,
                    const std::function<std::string()>& advice = {}) const;
};

/// The keys of S that the configuration file or a flag sets, and other keys of the file.
template <class S>
std::vector<std::string> given_keys(const Session& session) {
  std::vector<std::string> keys = session.options.config_keys;
  S settings;
  visit_fields(settings, [&](std::string_view key, auto&, const auto&...) {
    if (session.command.is_given(flag_of(key))) keys.emplace_back(key);
  });
  return keys;
}

/// Parses the command line and runs one command.
class Program {
 public:
  Program(const std::string& name, const std::string& description, const std::string& example);

  /// The program itself, for its flags.
  Command command() { return parser_.root(); }
  /// The number of threads without --threads; 0: all cores.
  void set_default_threads(uint64_t threads) { common_.process.threads = threads; }
  /// Adds a command with --help and the common flags, executed by `run`.
  Command add_command(const std::string& name, const std::string& description,
                      const std::string& example, std::function<void(Session&)> run);
  /// Makes the program itself a command, which runs if no other command is named.
  void set_run(std::function<void(Session&)> run);

  /// Adds --config FILE, which sets `settings` and common options before other flags do. A result
  /// file sets the settings and the seed of its run.
  template <class S>
  void add_config(const Command& command, S& settings) {
    add_config_option(command, [this, &settings](const Json& json, const std::string& where) {
      ConfigKeys<S> keys{settings, common_.process};
      value_from_json(json, keys, where, "the configuration");
    });
  }
  /// --config for a command without settings of its own.
  void add_config(const Command& command);

  /// Returns the exit code. Prints each error as one sentence on stderr.
  int main(int argc, char** argv);

 private:
  void add_common_flags(const Command& command);
  void add_config_option(const Command& command,
                         std::function<void(const Json&, const std::string&)> apply);
  void run_session(int argc, char** argv);
  int report(const Error& error);

  std::string name_;
  Parser parser_;
  std::string completion_;
  CommonOptions common_;
  Command chosen_;
  std::function<void(Session&)> run_;
};

}  // namespace vpr
