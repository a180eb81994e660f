// What all programs share: commands, settings from a file, signals, exit codes.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/json.h"
#include "parser.h"
#include "session.h"
#include "setting_flags.h"

namespace vpr {

/// Settings of a program and common ones, as one JSON object.
template <class S>
struct ConfigKeys {
  S& settings;
  CommonOptions& common;
};
template <class S, class Visitor>
void visit_fields(ConfigKeys<S>& keys, Visitor&& visit) {
  visit_fields(keys.settings, visit);
  visit_fields(keys.common, visit);
}

/// For a command whose configuration file holds common keys only.
struct NoSettings {};
template <class Visitor>
void visit_fields(NoSettings&, Visitor&&) {}

/// A program: parses, then runs the one command that was chosen.
class Program {
 public:
  Program(const std::string& name, const std::string& description, const std::string& example);

  /// The program's own flags.
  Command command() { return parser_.root(); }
  /// Threads where --threads is not given; 0: all cores.
  void set_default_threads(uint64_t threads) { common_.threads = threads; }
  /// A command with its own --help and the common flags. The work is done by `run`.
  Command add_command(const std::string& name, const std::string& description,
                      const std::string& example, std::function<void(Session&)> run);
  /// The program itself is the command, where none of its others is named.
  void set_run(std::function<void(Session&)> run);

  /// --config FILE fills `settings` and the common options before any flag does. A result file
  /// stands for the settings and the seed that it was made with.
  template <class S>
  void add_config(const Command& command, S& settings) {
    add_config_option(command, [this, &settings](const Json& json, const std::string& where) {
      ConfigKeys<S> keys{settings, common_};
      value_from_json(json, keys, where, "the configuration");
    });
  }

  /// Returns the exit code. Every known error becomes one sentence on stderr.
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
  std::function<void(Session&)> run_;
};

}  // namespace vpr
