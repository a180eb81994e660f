#include "session.h"

#include <cerrno>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "base/error.h"
#include "base/text.h"
#include "progress.h"

namespace vpr {
namespace {

// Throws Error(output).
void write_to_stdout(const std::string& text) {
  const bool written =
      std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written)
    throw Error(ErrorKind::output,
                fmt::format("standard output: can't be written: {}", system_error_text(errno)));
}

// Scripts get what names hold; on a terminal they are only shown.
void print_json(ProgressLine& progress, const std::string& text) {
  progress.clear();
  write_to_stdout(::isatty(STDOUT_FILENO) != 0 ? printable(text) : text);
}

}  // namespace

void Session::print(const std::string& text) const {
  progress.clear();
  write_to_stdout(printable(text));
}

void Session::print_line(const Json& json) const { print_json(progress, to_line(json) + "\n"); }

void Session::claim_output() const {
  if (!options.output.empty()) outputs.claim_file(options.output);
}

void Session::write_output(const Json& json) const {
  if (!options.output.empty()) outputs.file(options.output).write(to_text(json));
}

void Session::print_result(const std::string& text, const Json& json) const {
  const bool has_files = outputs.has_outputs();
  outputs.commit();
  try {
    if (options.json)
      print_json(progress, to_text(json));
    else if (!options.quiet)
      print(text);
  } catch (const Error& error) {
    if (!has_files) throw;
    const std::string sentence =
        fmt::format("{}; the output files are complete", std::string(error.what()));
    if (options.json) throw Error(error.kind(), sentence);
    warn(monitor, sentence);
  }
}

}  // namespace vpr
