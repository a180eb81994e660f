// What all programs share: common flags, settings from a file, progress, signals, exit codes.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/monitor.h"
#include "base/output_transaction.h"
#include "images/codec_scope.h"
#include "matching/row_kernels.h"
#include "parser.h"
#include "report/run_info.h"

namespace vpr {

struct CommonOptions {
  std::string output;
  std::string config;
  std::vector<std::string> config_keys;  ///< that the configuration gives values for
  uint64_t threads = 0;                  ///< 0: all cores
  uint64_t seed = 1;
  uint64_t max_megapixels = kUsualMegapixels;
  bool quiet = false;
  bool verbose = false;
  bool force = false;
  bool json = false;

  Existing existing() const { return force ? Existing::replace : Existing::refuse; }
};

/// Keys of a configuration file that are no settings of a method.
template <class Visitor>
void visit_fields(CommonOptions& options, Visitor&& visit) {
  visit("threads", options.threads);
  visit("seed", options.seed);
  visit("max_megapixels", options.max_megapixels);
}

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

class ProgressLine;

/// What a command gets to work with.
struct Session {
  const CommonOptions& options;
  const Monitor& monitor;
  RunInfo run;
  RowKernels kernels;
  ProgressLine& progress;
  OutputTransaction& outputs;

  /// Claims the file of --output, where it is given.
  void claim_output() const;
  /// Fills it with a JSON.
  void write_output(const Json& json) const;
  /// Prints to stdout, where a progress line has been before, what a terminal may show
  /// (printable); Error(output) if that fails (a full disk, a closed pipe).
  void print(const std::string& text) const;
  /// Commits the outputs of the run, and then prints a readable text, or with --json the JSON;
  /// neither with --quiet (but --json always). Where files are written, a text that can't be
  /// printed is a warning, for all that was asked for is there.
  void print_result(const std::string& text, const Json& json) const;
};

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

  std::string name_;
  Parser parser_;
  std::string completion_;
  CommonOptions common_;
  std::function<void(Session&)> run_;
};

/// The number or text that a flag means, as JSON: ".5", "+1" and "1e-3" are numbers here.
Json flag_value(const std::string& text);

/// Whether a field is one of some names, or may be.
template <class T>
inline constexpr bool kIsEnumField = std::is_enum_v<T>;
template <class T>
inline constexpr bool kIsEnumField<std::optional<T>> = std::is_enum_v<T>;

/// What a flag's value is called in help: the names of an enum, which completions offer, or a word.
template <class T>
std::string value_name() {
  if constexpr (detail::kIsOptional<T>)
    return value_name<typename T::value_type>();
  else if constexpr (std::is_enum_v<T>)
    return fmt::format("{}", fmt::join(kEnumNames<T>, "|"));
  else
    return std::is_arithmetic_v<T> ? "NUMBER" : "VALUE";
}

/// A flag that sets one field of a settings struct, with the same checks as in a file.
template <class T>
Flag add_setting(const Command& command, const std::string& flag, T& field,
                 const std::string& help) {
  return command
      .add_option(
          flag,
          [&field, flag](const std::string& text) {
            const bool is_text = std::is_same_v<T, std::string> || kIsEnumField<T>;
            value_from_json(is_text ? Json(text) : flag_value(text), field, "command line", flag);
          },
          help)
      .type_name(value_name<T>());
}

/// --max-memory; the help ends with the value that `bytes` has.
Flag add_memory_flag(const Command& command, size_t& bytes, const std::string& help);

/// Bytes from "512M", "2G", "1000000"; K, M, G are powers of 1024. Throws Error(usage).
size_t parse_bytes(const std::string& text, const std::string& flag);

}  // namespace vpr
