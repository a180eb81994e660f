// The one exception type of the toolkit: a kind, which becomes the exit code, and one sentence.
#pragma once

#include <stdexcept>
#include <string>

namespace vpr {

/// Whose mistake an error is; the programs turn it into their exit code.
enum class ErrorKind {
  usage,        ///< wrong flags or settings, or an output that exists (exit code 2)
  input,        ///< something to read is missing or can't be decoded (3)
  output,       ///< something can't be written (3)
  data,         ///< a database, result or ground truth is damaged or does not fit (4)
  expectation,  ///< a check that the user asked for failed (5)
  interrupted,  ///< the user stopped the program (130)
  internal      ///< a defect of ours (1)
};

/// Message: one sentence that says what was expected, what was found, where, and what to do.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

/// The process exit code that stands for an error kind.
int exit_code(ErrorKind kind);

/// "No space left on device" for an errno value, in any thread.
std::string system_error_text(int error_number);

}  // namespace vpr
