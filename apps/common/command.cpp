#include "command.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/provenance.h"
#include "base/simd.h"
#include "base/text.h"
#include "database/archive.h"
#include "progress.h"
#include "query/result_file.h"
#include "recordings/frame_order.h"
#include "recordings/sequence_source.h"
#include "truth/dataset.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> stop_wanted{false};  // set by a signal handler

void on_signal(int number) {
  stop_wanted = true;
  std::signal(number, SIG_DFL);  // a second Ctrl-C ends the program at once
}

// A mapped file has become shorter: the thread that reads it cannot go on.
void on_bus_error(int, siginfo_t* info, void*) {
  const fs::path* file = mapped_file_at(info->si_addr);
  remove_temporaries();
  const std::string text = fmt::format(
      "error: {}: became shorter while it was read. Repeat the command when the file "
      "is complete\n",
      file == nullptr ? "an input" : printable_line(file->string()));
  (void)!::write(STDERR_FILENO, text.data(), text.size());
  ::_exit(exit_code(ErrorKind::input));
}

// An output would get the number of a closed standard stream, and its messages.
void open_standard_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream)
    if (::fcntl(stream, F_GETFD) < 0) (void)::open("/dev/null", O_RDONLY);
}

void set_up_process() {
  open_standard_streams();
  struct sigaction bus_error {};
  bus_error.sa_sigaction = on_bus_error;
  bus_error.sa_flags = SA_SIGINFO | SA_RESETHAND;
  ::sigaction(SIGBUS, &bus_error, nullptr);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  if (std::signal(SIGHUP, on_signal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  std::cerr.rdbuf(nullptr);  // only OpenCV's codecs write to it
}

std::shared_ptr<spdlog::logger> make_logger(const CommonOptions& options) {
  auto logger = std::make_shared<spdlog::logger>(
      "vpr", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  logger->set_pattern("%^%l%$: %v");
  logger->set_level(options.quiet     ? spdlog::level::err
                    : options.verbose ? spdlog::level::debug
                                      : spdlog::level::info);
  return logger;
}

constexpr const char* kExitCodes =
    "  0    done\n"
    "  1    internal error: a defect of the program\n"
    "  2    wrong usage or configuration, or an existing output without --force\n"
    "  3    a file, folder or frame is missing, or cannot be read, decoded or written\n"
    "  4    a database, result or ground truth is damaged or does not match\n"
    "  5    an expectation was not met\n"
    "  130  interrupted";

// Cuts words that no reader needs whole, such as a cell of a damaged file.
std::string with_short_words(std::string_view text) {
  constexpr size_t kLongWord = 400;
  std::string result;
  bool is_first = true;
  for (const std::string_view word : split(text, ' ')) {
    if (!std::exchange(is_first, false)) result += ' ';
    result += word.size() <= kLongWord ? std::string(word) : shortened(word);
  }
  return result;
}

// Line feeds before indented lines are part of the message; all others are escaped.
void print_error(const std::string& program, const std::string& sentence) {
  std::string text;
  for (size_t begin = 0; begin <= sentence.size();) {
    const size_t end = std::min(sentence.find("\n  ", begin), sentence.size());
    text += (begin == 0 ? "" : "\n") +
            with_short_words(printable_line(sentence.substr(begin, end - begin)));
    begin = end + 1;
  }
  write_to_stderr(fmt::format("{}: {}\n", program, text));
}

std::string last_sections(const std::string& example) {
  return fmt::format("{}:\n{}\n\n{}:\n{}", kExampleSection, example, kExitCodeSection, kExitCodes);
}

// JSON contains names unchanged, except on a terminal.
void print_json(ProgressLine& progress, const std::string& text) {
  progress.clear();
  write_to_stdout(::isatty(STDOUT_FILENO) != 0 ? printable(text) : text);
}

// The flags that name outputs.
constexpr std::array kOutputs = {
    "output",      "save-matrix", "save-posteriors", "html",         "plot",
    "map",         "heat-map",    "save-config",     "outcomes-csv", "recognitions-csv",
    "descriptors", "junit",       "save-trajectory", "pairs",        "save-loops",
    "ask-frames",  "ask-places",  "ask-fabmap"};

/// Protects inputs that exist. Ignores unreadable ones, which the command reports.
struct Inputs {
  Outputs& outputs;

  // With its frames, but not with other files of their folder.
  void add_sequence(const SequenceArgument& argument) {
    std::error_code error;
    outputs.protect(argument.path);
    if (fs::exists(argument.path / kManifestName, error)) {
      for (const auto& entry : fs::directory_iterator(argument.path, error))
        outputs.protect(entry.path());
      return;
    }
    try {
      for (const fs::path& frame : open_sequence(argument).files) outputs.protect(frame);
    } catch (const Error&) {
    }
  }

  void add_truth(const std::optional<GroundTruthArgument>& truth) {
    if (!truth) return;
    outputs.protect(truth->path);
    GroundTruthOptions options = truth->options;
    visit_fields(options, [&](const char*, auto& option, const auto&...) {
      if constexpr (std::is_same_v<decltype(option), fs::path&>) outputs.protect(option);
    });
  }

  void add_dataset(const fs::path& path) {
    Dataset dataset;
    try {
      dataset = read_dataset(path);
    } catch (const Error&) {
      return;
    }
    for (const SequenceArgument& sequence : dataset.pretrain) add_sequence(sequence);
    for (const DatasetPlace& place : dataset.places)
      for (const SequenceArgument& view : place.views) add_sequence(view);
    for (const DatasetQuery& query : dataset.queries) {
      dataset.train.push_back(query.sequence);
      add_truth(query.sequence_ground_truth);
      add_truth(query.place_ground_truth);
    }
    for (const NamedSequence& sequence : dataset.train) {
      add_sequence(sequence.sequence);
      outputs.protect(sequence.poses);
    }
    outputs.protect(dataset.plan);
    outputs.protect(dataset.place_poses);
  }

  // PATH, PATH@RANGE, NAME=PATH or NAME=PATH@RANGE.
  void add_value(const std::string& value) {
    std::error_code error;
    const size_t equals = value.find('=');
    const bool has_name = equals != std::string::npos && !fs::exists(value, error);
    SequenceArgument argument;
    try {
      argument = parse_sequence_argument(has_name ? value.substr(equals + 1) : value);
    } catch (const Error&) {
      return;
    }
    add_sequence(argument);
    if (argument.path.extension() == ".json") outputs.protect(array_path(argument.path));
  }

  // Values of all arguments and flags: sequences with their frames, databases with their files,
  // results with their arrays, data sets with all files that they name.
  void add(const std::vector<GivenFlag>& given) {
    for (const GivenFlag& flag : given) {
      const auto has_name = [&](const char* name) {
        return std::ranges::find(flag.names, name) != flag.names.end();
      };
      if (std::ranges::any_of(kOutputs, has_name)) continue;
      for (const std::string& value : flag.values) {
        if (has_name("dataset")) add_dataset(value);
        add_value(value);
      }
    }
  }
};

void refuse_empty(const std::vector<GivenFlag>& given) {
  for (const GivenFlag& flag : given)
    if (std::ranges::any_of(flag.values, &std::string::empty))
      throw Error(ErrorKind::usage, "{} is empty. Is a variable of the shell unset?",
                  flag.names.empty() ? "an argument" : "--" + flag.names.back());
}

}  // namespace

void Session::print_line(const Json& json) const { print_json(progress, to_line(json) + "\n"); }

void claim_charts(Outputs& outputs, const std::string& folder) {
  for (const char* extension : {".png", ".svg", ".pdf", ".html", ".jpg"})
    if (folder.ends_with(extension))
      throw Error(ErrorKind::usage,
                  "{} names a file, and charts fill a folder, as in --plot charts", folder);
  outputs.claim_folder(folder, is_marked_folder);
}

void Session::claim_output(const std::vector<std::string>& files, const std::string& plots) const {
  if (!options.output.empty()) claim_over_result(options.output, outputs);
  for (const std::string& file : files)
    if (!file.empty()) outputs.claim_file(file);
  if (!plots.empty()) claim_charts(outputs, plots);
}

void Session::write_output(const Json& json) const {
  if (!options.output.empty()) outputs.file(options.output).write(to_text(json));
}

void Session::print_result(const std::string& text, const Json& json,
                           const std::function<std::string()>& advice) const {
  const bool has_files = outputs.has_outputs();
  outputs.commit();
  try {
    if (options.json) print_json(progress, to_text(json));
    if (!prints_text()) return;
    progress.clear();
    write_to_stdout(printable(text));
    if (!advice) return;
    const std::string sentences = advice();
    progress.clear();
    write_to_stdout(printable(sentences));
  } catch (const Error& error) {
    if (!has_files) throw;
    const bool is_interrupted = error.kind() == ErrorKind::interrupted;
    const std::string sentence = fmt::format("{}; the output files are complete",
                                             is_interrupted ? "interrupted" : error.what());
    if (options.json || is_interrupted) throw Error(error.kind(), sentence);
    warn(monitor, sentence);
  }
}

Program::Program(const std::string& name, const std::string& description,
                 const std::string& example)
    : name_(name),
      parser_(name, description,
              fmt::format("{} {} ({})", name, program_version(), program_commit())),
      chosen_(parser_.root()) {
  command().add_footer(last_sections(example));
  command().add_option(
      "--completion", completion_,
      "print completions for a shell, or the manual page; cannot be combined with other flags",
      kCommonGroup, "bash|zsh|fish|man");
}

Command Program::add_command(const std::string& name, const std::string& description,
                             const std::string& example, std::function<void(Session&)> run) {
  const Command command =
      parser_.add_command(name, description, [this, run = std::move(run)](const Command& chosen) {
        chosen_ = chosen;
        run_ = run;
      });
  command.add_footer(last_sections(example));
  add_common_flags(command);
  if (!run_) parser_.require_command(true);
  return command;
}

void Program::set_run(std::function<void(Session&)> run) {
  add_common_flags(command());
  parser_.require_command(false);
  run_ = std::move(run);
}

void Program::add_common_flags(const Command& command) {
  command.add_option("-o,--output", common_.output, "output file or folder");
  add_setting(command, "--threads", common_.process.threads,
              fmt::format("number of threads; 0: all cores (default: {})", common_.process.threads),
              kCommonGroup);
  add_setting(command, "--seed", common_.process.seed, "seed of all random choices (default: 1)",
              kCommonGroup);
  add_setting(command, "--order", common_.process.order,
              "order of the images in folders: natural, name (as bytes), time (names are numbers), "
              "auto (natural, but decimal numbers by value), or rows (auto, but UTM names as "
              "bytes) (default: auto; rows for vpr-eval matrix)",
              kCommonGroup);
  add_setting(command, "--max-megapixels", common_.process.max_megapixels,
              fmt::format("largest size of images and video frames, in megapixels (default: {})",
                          kDefaultMegapixels),
              kCommonGroup);
  command.add_flag("--quiet", common_.quiet, "omit progress, warnings and tables", kCommonGroup);
  command.add_flag("-v,--verbose", common_.verbose, "print details", kCommonGroup);
  command.add_flag("--force", common_.force, "replace existing outputs", kCommonGroup);
  command.add_flag("--json", common_.json, "print the result as JSON on standard output",
                   kCommonGroup);
}

void Program::add_config(const Command& command) {
  add_config_option(command, [this](const Json& json, const std::string& where) {
    value_from_json(json, common_.process, where, "the configuration");
  });
}

void Program::add_config_option(const Command& command,
                                std::function<void(const Json&, const std::string&)> apply) {
  command
      .add_option(
          "--config",
          [this, apply = std::move(apply)](const std::string& path) {
            if (path.empty()) return;  // which refuse_empty reports
            common_.config = path;
            const Json json = read_config(path);
            if (json.is_object())
              for (const auto& item : json.items()) {
                if (item.value().is_string() && item.value().get<std::string>().empty())
                  throw Error(ErrorKind::usage, "{}: the value of \"{}\" is empty. Omit it", path,
                              item.key());
                common_.config_keys.push_back(item.key());
              }
            apply(json, path);
          },
          "settings from a JSON file or a result; flags override them", kCommonGroup, "FILE")
      .read_first();
}

void Program::run_session(int argc, char** argv) {
  const auto logger = make_logger(common_);
  mute_codecs();
  ProgressLine progress(!common_.quiet);
  Monitor monitor;
  monitor.progress = [&](const std::string& step, size_t done, size_t total) {
    progress.show(step, done, total);
  };
  monitor.warn = [&](const std::string& sentence) {
    progress.clear();
    logger->warn(printable_line(sentence));
  };
  monitor.stop = &stop_wanted;
  const ProcessScope scope(common_.process);
  const char* simd = std::getenv("VPR_SIMD");
  use_simd_target(simd == nullptr ? "" : simd);
  refuse_empty(parser_.given());
  Outputs outputs(common_.force ? Existing::replace : Existing::refuse);
  if (common_.force) Inputs{outputs}.add(parser_.given());  // without it, no file is replaced
  Session session{common_, chosen_, monitor, {}, progress, outputs};
  session.run = run_of(name_, {argv, argv + argc}, common_.process.seed);
  logger->debug("{} {}, {} threads, SIMD target {}", program_version(), program_commit(),
                session.run.threads, session.run.simd_target);
  try {
    run_(session);
    outputs.commit();
    if (chosen_.is_given("--order") && !is_frame_order_used())
      warn(monitor, "--order has no effect: no folder of frames was read");
  } catch (const Error& error) {
    throw Error(error.kind(), outputs.with_targets(error.what()));
  }
}

int Program::report(const Error& error) {
  print_error(name_, error.what());
  return exit_code(error.kind());
}

int Program::main(int argc, char** argv) {
  set_up_process();
  try {
    if (argc == 3 && std::string_view(argv[1]) == "--completion") {
      write_to_stdout(completion_text(parser_.describe(), argv[2], program_version()));
      return 0;
    }
    if (!parser_.parse(argc, argv)) return 0;
    if (parser_.root().is_given("--completion"))
      throw Error(ErrorKind::usage,
                  "--completion cannot be combined with other arguments; use {} --completion bash",
                  name_);
    run_session(argc, argv);
    return 0;
  } catch (const Error& error) {
    return report(error);
  } catch (const std::bad_alloc&) {
    return report({ErrorKind::internal, "out of memory; use fewer frames{}",
                   parser_.takes("--max-memory") ? " or a lower --max-memory" : ""});
  } catch (const fs::filesystem_error& error) {
    return report({ErrorKind::output, "{}: cannot be read or written: {}", error.path1().string(),
                   error.code().message()});
  } catch (const std::exception& error) {
    return report({ErrorKind::internal, "internal error, please report it: {}", error.what()});
  }
}

}  // namespace vpr
