#include "command.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "base/error.h"
#include "base/json.h"
#include "base/parallel.h"
#include "base/provenance.h"
#include "base/simd.h"
#include "base/text.h"
#include "completion.h"
#include "parser.h"
#include "progress.h"
#include "session.h"

namespace vpr {
namespace {

constexpr uint64_t kMostThreads = 1024;

std::atomic<bool> stop_wanted{false};  // set by a signal handler

void on_signal(int number) {
  stop_wanted = true;
  std::signal(number, SIG_DFL);  // a second Ctrl-C ends the program at once
}

void set_up_process() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  cv::setNumThreads(1);        // frames are worked on in parallel, not parts of one
  cv::setUseOptimized(false);  // features would differ between machines with and without AVX2
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  std::cerr.rdbuf(nullptr);  // OpenCV's codecs write there, and nothing of ours
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
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
    "  2    usage, configuration, or an existing output without --force\n"
    "  3    a file, folder or frame is missing, or can't be read, decoded or written\n"
    "  4    a database, result or ground truth is damaged or does not fit\n"
    "  5    an expectation was not met\n"
    "  130  interrupted";

// A list in a sentence has indented lines of its own; a name in it begins none.
void print_error(const std::string& program, const std::string& sentence) {
  std::string text;
  for (size_t begin = 0; begin <= sentence.size();) {
    const size_t end = std::min(sentence.find("\n  ", begin), sentence.size());
    text += (begin == 0 ? "" : "\n") + printable_line(sentence.substr(begin, end - begin));
    begin = end + 1;
  }
  fmt::print(stderr, "{}: {}\n", program, text);
}

std::string last_sections(const std::string& example) {
  return fmt::format("{}:\n{}\n\n{}:\n{}", kExampleSection, example, kExitCodeSection, kExitCodes);
}

}  // namespace

Program::Program(const std::string& name, const std::string& description,
                 const std::string& example)
    : name_(name),
      parser_(name, description,
              fmt::format("{} {} ({})", name, program_version(), program_commit())) {
  command().add_footer(last_sections(example));
  command()
      .add_option("--completion", completion_,
                  "print completions for bash, or the manual page; nothing else may be given")
      .type_name("bash|man")
      .group(kCommonGroup);
}

Command Program::add_command(const std::string& name, const std::string& description,
                             const std::string& example, std::function<void(Session&)> run) {
  const Command command =
      parser_.add_command(name, description, [this, run = std::move(run)] { run_ = run; });
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
  const auto group = [](Flag flag) { flag.group(kCommonGroup); };
  group(command.add_option("-o,--output", common_.output, "where the result goes"));
  group(add_setting(
      command, "--threads", common_.threads,
      fmt::format(
          "threads to use; 0: all cores{}",
          common_.threads == 0 ? " (default)" : fmt::format("; default {}", common_.threads))));
  group(add_setting(command, "--seed", common_.seed,
                    "seed of everything that is random (default 1)"));
  group(add_setting(
      command, "--max-megapixels", common_.max_megapixels,
      fmt::format("refuse images and videos of larger frames (default {})", kUsualMegapixels)));
  group(command.add_flag("--quiet", common_.quiet, "no progress, no warnings, no table"));
  group(command.add_flag("-v,--verbose", common_.verbose, "say more"));
  group(command.add_flag("--force", common_.force, "replace an existing output"));
  group(command.add_flag("--json", common_.json, "print the result as JSON on standard output"));
}

void Program::add_config_option(const Command& command,
                                std::function<void(const Json&, const std::string&)> apply) {
  command
      .add_option(
          "--config",
          [this, apply = std::move(apply)](const std::string& path) {
            common_.config = path;
            const Json json = read_config(path);
            if (json.is_object())
              for (const auto& item : json.items()) common_.config_keys.push_back(item.key());
            apply(json, path);
          },
          "settings from a JSON file, or those of a result (flags win)")
      .type_name("FILE")
      .group(kCommonGroup)
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
  if (common_.threads > kMostThreads)
    throw Error(ErrorKind::usage, fmt::format("--threads must be at most {}, found {}",
                                              kMostThreads, common_.threads));
  const ThreadLimit limit(common_.threads);
  const MegapixelLimit pixels(common_.max_megapixels);
  const char* simd = std::getenv("VPR_SIMD");
  use_simd_target(simd == nullptr ? "" : simd);
  Outputs outputs(common_.existing());
  // Without --force, nothing that exists is replaced anyway.
  if (common_.force)
    for (const std::filesystem::path& input : run_inputs(parser_.given())) outputs.protect(input);
  Session session{common_, monitor, {}, select_kernels(), progress, outputs};
  session.run.program = name_;
  session.run.command_line.assign(argv, argv + argc);
  session.run.threads = thread_count();
  session.run.seed = common_.seed;
  logger->debug("{} {}, {} threads, SIMD target {}", program_version(), program_commit(),
                session.run.threads, session.kernels.target);
  try {
    run_(session);
    outputs.commit();
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
    if (argc == 3 && std::string_view(argv[1]) == "--completion") {  // for the installation
      fmt::print("{}", command_text(parser_.describe(), argv[2], program_version()));
      return 0;
    }
    if (!parser_.parse(argc, argv)) return 0;
    if (command().is_given("--completion"))
      throw Error(ErrorKind::usage,
                  fmt::format("--completion stands alone, as in {} --completion bash", name_));
    run_session(argc, argv);
    return 0;
  } catch (const Error& error) {
    return report(error);
  } catch (const std::bad_alloc&) {
    return report({ErrorKind::internal,
                   fmt::format("out of memory; use fewer frames{}",
                               parser_.takes(kMemoryFlag) ? " or a lower --max-memory" : "")});
  } catch (const std::filesystem::filesystem_error& error) {
    return report({ErrorKind::output, fmt::format("{}: can't be read or written: {}",
                                                  error.path1().string(), error.code().message())});
  } catch (const std::exception& error) {
    return report(
        {ErrorKind::internal, fmt::format("internal error, please report it: {}", error.what())});
  }
}

}  // namespace vpr
